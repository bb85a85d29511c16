// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "ltmd/export.h"

/// A corner-based triangle mesh, held by its caller.
///
/// Conventions: positions in Blender units (any unit serves: only ratios matter), UV = (u, v) with
/// v up, tile (0, 0) = UDIM 1001, triangles counter-clockwise seen from the front, all arrays
/// contiguous. The host triangulates, so n-gons are cut as the renderer cuts them.
namespace ltmd::inline v0 {

using Vec2f = std::array<float, 2>;
using Vec3f = std::array<float, 3>;
using Triangle = std::array<std::int32_t, 3>;

/// Non-owning arrays of a mesh: T triangles of corner indices, C corners, V vertices.
struct MeshView {
    std::span<const Triangle> triangles;        ///< [T] indices of corners, 0 to C-1.
    std::span<const std::int32_t> corner_vert;  ///< [C] index of each corner's vertex, 0 to V-1.
    std::span<const Vec2f> corner_uv;           ///< [C], or empty for a mesh without a UV map.
    std::int32_t vertex_count = 0;              ///< V.

    bool has_uv() const { return !corner_uv.empty() || corner_vert.empty(); }
};

/// A UV tile: the unit square with lower left corner (u, v).
struct Tile {
    int u = 0;
    int v = 0;
    auto operator<=>(const Tile&) const = default;
};

/// The UDIM number of a tile with 0 <= u <= 9 and 0 <= v <= 99; throws InvalidInput outside.
LTMD_API int udim(Tile tile);

/// Throws InvalidInput when an index is out of range, the UV array has another length than the
/// corners, a UV is not finite, or there are more than 715827882 triangles; the message names the
/// first culprit. An empty mesh is valid.
LTMD_API void validate(const MeshView& mesh);

/// Throws InvalidInput when the number of positions is not the mesh's vertex count, or a position
/// is not finite (the first such vertex is named). `what` names the state in the message, such as
/// "deformed".
LTMD_API void validate_positions(const MeshView& mesh, std::span<const Vec3f> positions,
                                 const char* what);

/// Throws InvalidInput when the mesh has no UV map.
LTMD_API void require_uv(const MeshView& mesh);

/// The tiles that triangles with UV area reach into, sorted by (v, u); a triangle that only touches
/// a tile's border is not in it.
LTMD_API std::vector<Tile> tiles(const MeshView& mesh);

}  // namespace ltmd::inline v0
