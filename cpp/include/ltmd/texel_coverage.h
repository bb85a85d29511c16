// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ltmd/export.h"
#include "ltmd/mesh_view.h"

/// Which triangle each texel of a UV tile belongs to, computed once per mesh and used for every frame.
///
/// A texel whose centre lies in a triangle takes that triangle (the lowest index where several overlap). A texel that a
/// triangle only touches, and the texels up to `margin` texels away, take the nearest point of the nearest triangle
/// of this UV layout: values continue past a chart's border in that chart's own frame.
namespace ltmd::inline v0 {

/// A texel's triangle and barycentric weights of its first two corners (the third is 1 - b0 - b1).
struct CoverageTexel {
    std::int32_t triangle = -1;  ///< -1: not covered, takes the background.
    float b0 = 0;
    float b1 = 0;
};

class LTMD_API TexelCoverage {
public:
    /// Size 1 to 65536 on each side, margin 0 to 64 texels, any tile. Throws InvalidInput (also for a mesh without UV map).
    /// A tile that no triangle reaches is valid and wholly background.
    TexelCoverage(const MeshView& mesh, int width, int height, Tile tile = {}, int margin = 16);

    int width() const { return width_; }
    int height() const { return height_; }
    std::span<const CoverageTexel> texels() const { return texels_; }  ///< [height * width], row 0 = top.
    std::span<const Triangle> triangles() const { return triangles_; } ///< The mesh's triangles (corner indices), copied.
    std::size_t corner_count() const { return corner_count_; }
    std::size_t covered() const { return covered_; }          ///< Texel centres in at least one triangle.
    std::size_t overlapping() const { return overlapping_; }  ///< Texel centres in more than one triangle.

private:
    int width_, height_;
    std::size_t corner_count_ = 0, covered_ = 0, overlapping_ = 0;
    std::vector<CoverageTexel> texels_;
    std::vector<Triangle> triangles_;
};

/// Covered texel centres that lie in more than one triangle, as a part of all covered ones (0 to 1), over all tiles of the mesh,
/// each rasterised at resolution x resolution.
LTMD_API double overlap_fraction(const MeshView& mesh, int resolution = 1024);

}  // namespace ltmd::inline v0
