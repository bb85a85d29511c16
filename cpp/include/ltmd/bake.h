// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltmd/export.h"
#include "ltmd/texel_coverage.h"

/// Values of a mesh gathered into the texels of a prepared coverage.
///
/// Channels: 1 to 16 in the values, and in the texels as many or one more, which is set to 1: a
/// finite alpha.
namespace ltmd::inline v0 {

/// Writes per-corner values into texels: each texel takes its triangle's corners by its barycentric
/// weights. Equal corners give exactly their value.
///
/// `corner_values`: [C * channels]. `background`: [channels], the value of texels no triangle
/// reaches (the identity for tension, never black). `out`: [height * width * out_channels], row 0 =
/// top. Throws InvalidInput for wrong sizes.
LTMD_API void bake(const TexelCoverage& coverage, std::span<const float> corner_values,
                   int channels, std::span<const float> background, int out_channels,
                   std::span<float> out);

/// As bake() with one value per triangle, not interpolated: `triangle_values` is [T * channels].
LTMD_API void bake_flat(const TexelCoverage& coverage, std::span<const float> triangle_values,
                        int channels, std::span<const float> background, int out_channels,
                        std::span<float> out);

}  // namespace ltmd::inline v0
