// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ltmd/export.h"
#include "ltmd/mesh_view.h"

/// Which triangle each texel of a UV tile belongs to, computed once per mesh and used for every
/// frame.
///
/// Texel (column i, row j) has its centre at u = (i + 0.5) / width, v = 1 - (j + 0.5) / height of
/// its tile: row 0 is the top. A texel whose centre lies in a triangle (border included) takes that
/// triangle, the lowest index where several do. A texel whose inside a triangle only meets, and the
/// texels whose centre is at most `margin` texels from a triangle, take the nearest point of the
/// nearest triangle of the whole layout (the lowest index at equal distance), so values continue
/// past a chart's border in that chart's own frame. Triangles without UV area cover nothing.
///
/// Exact up to double rounding of the distance, with the same bits for any thread count.
namespace ltmd::inline v0 {

/// A texel's triangle and barycentric weights of its first two corners (the third is 1 - b0 - b1);
/// all three are in [0, 1].
struct CoverageTexel {
    std::int32_t triangle;  ///< -1: not covered, takes the background; then b0 = b1 = 0.
    float b0;
    float b1;
};

class LTMD_API TexelCoverage {
public:
    /// Size 1 to 65536 on each side, margin 0 to 64 texels, any tile. Throws InvalidInput (also for
    /// a mesh without UV map). A tile that no triangle reaches is valid and wholly background.
    TexelCoverage(const MeshView& mesh, int width, int height, Tile tile = {}, int margin = 16);

    int width() const { return width_; }
    int height() const { return height_; }
    Tile tile() const { return tile_; }
    std::span<const CoverageTexel> texels() const {  ///< [height * width], row 0 = top.
        return {texels_.get(),
                static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)};
    }
    std::span<const Triangle> triangles() const {
        return triangles_;
    }  ///< The mesh's triangles (corner indices), copied.
    std::size_t corner_count() const { return corner_count_; }
    std::size_t covered() const { return covered_; }  ///< Texel centres in at least one triangle.
    std::size_t overlapping() const {
        return overlapping_;
    }  ///< Texel centres strictly inside more than one triangle.

private:
    int width_, height_;
    Tile tile_;
    std::size_t corner_count_ = 0, covered_ = 0, overlapping_ = 0;
    std::unique_ptr<CoverageTexel[]>
        texels_;  // not a vector: 200 MB at 4096 x 4096 that each thread fills itself
    std::vector<Triangle> triangles_;
};

/// Covered texel centres that lie strictly inside more than one triangle, as a part of all covered
/// ones (0 to 1), over all tiles of the mesh, each rasterised at resolution x resolution.
LTMD_API double overlap_fraction(const MeshView& mesh, int resolution = 1024);

}  // namespace ltmd::inline v0
