// SPDX-License-Identifier: Apache-2.0
#include "ltmd/mesh_view.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "ltmd/errors.h"
#include "ltmd/tangent_frame.h"
#include "parallel.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 16;
constexpr float max_tile = 1000;
// The corners of all triangles are counted in 32 bits.
constexpr std::size_t max_triangles = std::numeric_limits<std::int32_t>::max() / 3;

/// The first index in [0, count) for which bad(index) holds, or count.
template <class Predicate>
std::size_t first_index(std::size_t count, const Predicate& bad) {
    std::atomic<std::size_t> first{count};
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        bool any = false;
        for (std::size_t i = begin; i < end; ++i) any |= bad(i);
        if (!any) return;
        std::size_t i = begin;
        while (!bad(i)) ++i;
        for (std::size_t seen = first; i < seen && !first.compare_exchange_weak(seen, i);) {
        }
    });
    return first;
}

bool is_finite(const Vec3f& p) {
    // A sum of zeros, unless a component is infinite or NaN.
    return p[0] * 0 + p[1] * 0 + p[2] * 0 == 0;
}

/// Whether the open triangle and the open unit square at `tile` overlap (separating axes).
bool overlaps(const Tile& tile, const std::array<Vec2f, 3>& uv) {
    const double low[2] = {static_cast<double>(tile.u), static_cast<double>(tile.v)};
    for (int i = 0; i < 3; ++i) {
        const Vec2f &a = uv[i], &b = uv[(i + 1) % 3], &c = uv[(i + 2) % 3];
        const double nx = static_cast<double>(b[1]) - a[1], ny = static_cast<double>(a[0]) - b[0];
        const double side =
            nx * (static_cast<double>(c[0]) - a[0]) + ny * (static_cast<double>(c[1]) - a[1]);
        const double sign = side < 0 ? -1 : 1;
        double farthest = -HUGE_VAL;
        for (int corner = 0; corner < 4; ++corner) {
            const double u = low[0] + (corner & 1), v = low[1] + (corner >> 1);
            farthest = std::max(farthest, sign * (nx * (u - a[0]) + ny * (v - a[1])));
        }
        if (farthest <= 0) return false;
    }
    return true;
}

}  // namespace

int udim(Tile tile) {
    if (tile.u < 0 || tile.u > 9 || tile.v < 0 || tile.v > 99)
        throw InvalidInput("tile (" + std::to_string(tile.u) + ", " + std::to_string(tile.v) +
                           ") has no UDIM number: u must be 0 to 9 and v 0 to 99");
    return 1001 + tile.u + 10 * tile.v;
}

void validate(const MeshView& mesh) {
    if (mesh.vertex_count < 0)
        throw InvalidInput("vertex_count is " + std::to_string(mesh.vertex_count) +
                           "; it must be 0 or more");
    if (mesh.triangles.size() > max_triangles)
        throw InvalidInput("the mesh has " + std::to_string(mesh.triangles.size()) +
                           " triangles; at most " + std::to_string(max_triangles) + " are allowed");
    const auto corners = static_cast<std::int64_t>(mesh.corner_vert.size());
    if (!mesh.corner_uv.empty() && mesh.corner_uv.size() != mesh.corner_vert.size())
        throw InvalidInput("corner_uv has " + std::to_string(mesh.corner_uv.size()) +
                           " entries; corner_vert has " + std::to_string(corners));
    const std::size_t triangle = first_index(mesh.triangles.size(), [&](std::size_t i) {
        bool bad = false;
        for (int c : mesh.triangles[i]) bad |= c < 0 || c >= corners;
        return bad;
    });
    if (triangle < mesh.triangles.size()) {
        const Triangle& t = mesh.triangles[triangle];
        throw InvalidInput("triangle " + std::to_string(triangle) + " has corners (" +
                           std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " +
                           std::to_string(t[2]) + "); the mesh has corners 0 to " +
                           std::to_string(corners - 1));
    }
    const std::size_t corner = first_index(mesh.corner_vert.size(), [&](std::size_t i) {
        return mesh.corner_vert[i] < 0 || mesh.corner_vert[i] >= mesh.vertex_count;
    });
    if (corner < mesh.corner_vert.size())
        throw InvalidInput("corner " + std::to_string(corner) + " has vertex " +
                           std::to_string(mesh.corner_vert[corner]) +
                           "; the mesh has vertices 0 to " + std::to_string(mesh.vertex_count - 1));
    const std::size_t uv = first_index(mesh.corner_uv.size(), [&](std::size_t i) {
        return !is_finite({mesh.corner_uv[i][0], mesh.corner_uv[i][1], 0});
    });
    if (uv < mesh.corner_uv.size())
        throw InvalidInput("the UV of corner " + std::to_string(uv) + " is not finite");
}

void validate_positions(const MeshView& mesh, std::span<const Vec3f> positions, const char* what) {
    if (positions.size() != static_cast<std::size_t>(mesh.vertex_count))
        throw InvalidInput(std::string(what) + " positions have " +
                           std::to_string(positions.size()) + " vertices; the mesh has " +
                           std::to_string(mesh.vertex_count));
    const std::size_t vertex =
        first_index(positions.size(), [&](std::size_t i) { return !is_finite(positions[i]); });
    if (vertex < positions.size())
        throw InvalidInput("the " + std::string(what) + " position of vertex " +
                           std::to_string(vertex) + " is not finite");
}

void require_uv(const MeshView& mesh) {
    if (!mesh.has_uv())
        throw InvalidInput("the mesh has no UV map: give corner_uv, or use the deformation tensor");
}

std::vector<Tile> tiles(const MeshView& mesh) {
    validate(mesh);
    require_uv(mesh);
    const auto by_row = [](const Tile& a, const Tile& b) {
        return a.v != b.v ? a.v < b.v : a.u < b.u;
    };
    std::set<Tile, decltype(by_row)> found(by_row);
    for (const Triangle& t : mesh.triangles) {
        const std::array<Vec2f, 3> uv = {mesh.corner_uv[t[0]], mesh.corner_uv[t[1]],
                                         mesh.corner_uv[t[2]]};
        if (uv_area_sign(uv[0], uv[1], uv[2]) == 0) continue;
        int first[2], last[2];
        for (int axis = 0; axis < 2; ++axis) {
            const auto [low, high] = std::minmax({uv[0][axis], uv[1][axis], uv[2][axis]});
            if (low < -max_tile || high > max_tile)
                throw InvalidInput("the UVs of corners " + std::to_string(t[0]) + ", " +
                                   std::to_string(t[1]) + ", " + std::to_string(t[2]) + " reach " +
                                   std::to_string(low < -max_tile ? low : high) +
                                   "; tiles from -1000 to 1000 are allowed");
            first[axis] = static_cast<int>(std::floor(low));
            last[axis] = std::max(first[axis], static_cast<int>(std::ceil(high)) - 1);
        }
        for (int v = first[1]; v <= last[1]; ++v)
            for (int u = first[0]; u <= last[0]; ++u)
                if ((first[0] == last[0] && first[1] == last[1]) || overlaps({u, v}, uv))
                    found.insert({u, v});
    }
    return {found.begin(), found.end()};
}

}  // namespace ltmd::inline v0
