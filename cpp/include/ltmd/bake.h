// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltmd/export.h"
#include "ltmd/texel_coverage.h"

namespace ltmd::inline v0 {

/// Writes per-corner values into texels: each texel takes the barycentric mean of its triangle's corners at the texel's centre.
///
/// `corner_values`: [C * channels]. `background`: [channels], the value of texels no triangle reaches (the identity for tension, never black).
/// `out`: [height * width * out_channels], row 0 = top; channels past `channels` (at most one) are set to 1: a finite alpha.
/// Throws InvalidInput for wrong sizes, or channels outside 1 to 16.
LTMD_API void bake(const TexelCoverage& coverage, std::span<const float> corner_values, int channels,
                   std::span<const float> background, int out_channels, std::span<float> out);

}  // namespace ltmd::inline v0
