// SPDX-License-Identifier: Apache-2.0
// This work is based on: microsurface-transformations, section 5.1.
#include "ltmd/rest_state.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

#include "ltmd/tangent_frame.h"
#include "parallel.h"
#include "rest_state_data.h"
#include "vector_math.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 13;

/// One triangle at one vertex, with what decides its fan.
struct Incidence {
    std::int32_t other;  ///< The vertex at the far end of an edge.
    std::uint32_t u, v;  ///< Bits of the UV at this vertex.
    int sign;            ///< Of the UV area.
    std::int32_t entry;  ///< Position in the vertex's list of triangles.

    auto key() const { return std::tuple(other, u, v, sign); }
};

void prepare_triangles(const MeshView& mesh, std::span<const Vec3f> positions,
                       RestState::Data& data) {
    const std::size_t count = mesh.triangles.size();
    data.vertices.resize(count);
    for (auto& entry : data.inverse_rest) entry.resize(count);
    data.weight.resize(count);
    std::vector<double> area(count);
    data.state.resize(count);
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle& corners = mesh.triangles[i];
            auto& vertex = data.vertices[i];
            for (int k = 0; k < 3; ++k) vertex[k] = mesh.corner_vert[corners[k]];
            const V3d p0 = to_double(positions[vertex[0]]);
            const V3d e1 = to_double(positions[vertex[1]]) - p0,
                      e2 = to_double(positions[vertex[2]]) - p0;
            const V3d cross = e1.cross(e2);
            area[i] = cross.length();
            if (has_no_area(e1, e2, cross)) {
                data.state[i] = TriangleState::no_area;
                continue;
            }
            const V3d z = cross.normalized();
            V3d x = e1.normalized();
            data.state[i] = TriangleState::no_uv;
            if (mesh.has_uv()) {
                TangentFrame frame;
                if (tangent_frame(positions[vertex[0]], positions[vertex[1]], positions[vertex[2]],
                                  mesh.corner_uv[corners[0]], mesh.corner_uv[corners[1]],
                                  mesh.corner_uv[corners[2]], frame)) {
                    x = V3d(frame.x[0], frame.x[1], frame.x[2]);
                    data.state[i] = TriangleState::regular;
                }
            }
            const V3d y = z.cross(x);
            const double r11 = e1.dot(x), r12 = e2.dot(x), r21 = e1.dot(y), r22 = e2.dot(y);
            const double det = r11 * r22 - r12 * r21;
            data.inverse_rest[0][i] = r22 / det;
            data.inverse_rest[1][i] = -r12 / det;
            data.inverse_rest[2][i] = -r21 / det;
            data.inverse_rest[3][i] = r11 / det;
        }
    });
    // Relative to the largest, so that meshes of any scale keep their weights.
    const double largest = count ? *std::max_element(area.begin(), area.end()) : 0;
    for (std::size_t i = 0; i < count; ++i)
        data.weight[i] = largest > 0 ? static_cast<float>(area[i] / largest) : 0.0f;
}

void list_triangles_of_vertices(RestState::Data& data) {
    std::vector<std::int32_t>& offsets = data.vertex_triangles.offsets;
    offsets.assign(data.vertex_count + 1, 0);
    for (const auto& vertex : data.vertices)
        for (std::int32_t v : vertex) ++offsets[v + 1];
    std::inclusive_scan(offsets.begin(), offsets.end(), offsets.begin());
    data.listed.resize(offsets.back());
    data.vertex_triangles.triangles = data.listed;
    std::vector<std::int32_t> next(offsets.begin(), offsets.end() - 1);
    for (std::size_t i = 0; i < data.vertices.size(); ++i)
        for (std::int32_t v : data.vertices[i])
            data.listed[next[v]++] = static_cast<std::int32_t>(i);
}

std::vector<signed char> uv_signs(const MeshView& mesh) {
    std::vector<signed char> signs(mesh.triangles.size());
    parallel_for(mesh.triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle& t = mesh.triangles[i];
            signs[i] = static_cast<signed char>(
                uv_area_sign(mesh.corner_uv[t[0]], mesh.corner_uv[t[1]], mesh.corner_uv[t[2]]));
        }
    });
    return signs;
}

/// Finds the fans: at each vertex, triangles that share an edge, the vertex's UV and the sign of
/// the UV area are joined. Orders each vertex's triangles by fan.
void prepare_fans(const MeshView& mesh, const std::vector<signed char>& signs,
                  RestState::Data& data) {
    const auto corner_at = [&](std::int32_t triangle, std::int32_t vertex) {
        int k = 0;
        while (data.vertices[triangle][k] != vertex) ++k;
        return mesh.triangles[triangle][k];
    };

    // Number the fans of each vertex 0, 1, ... in the order of their lowest triangle. In the
    // vertex's list the first triangle of each fan is marked by its complement.
    std::vector<std::int32_t> first_fan(data.vertex_count + 1, 0);
    data.corner_fan.assign(data.corner_count, -1);
    parallel_for(data.vertex_count, grain, [&](std::size_t begin, std::size_t end) {
        std::vector<Incidence> edges;
        std::vector<std::int32_t> root, triangles, fan_of, fan_sign, next;
        const auto find = [&](std::int32_t i) {
            while (root[i] != i) i = root[i] = root[root[i]];
            return i;
        };
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const auto list = data.vertex_triangles[vertex];
            triangles.assign(list.begin(), list.end());
            edges.clear();
            root.resize(triangles.size());
            std::iota(root.begin(), root.end(), 0);
            for (std::size_t entry = 0; entry < triangles.size(); ++entry) {
                const std::int32_t triangle = triangles[entry];
                const Vec2f& uv =
                    mesh.corner_uv[corner_at(triangle, static_cast<std::int32_t>(vertex))];
                for (std::int32_t other : data.vertices[triangle])
                    if (other != static_cast<std::int32_t>(vertex))
                        edges.push_back({other, std::bit_cast<std::uint32_t>(uv[0]),
                                         std::bit_cast<std::uint32_t>(uv[1]), signs[triangle],
                                         static_cast<std::int32_t>(entry)});
            }
            std::sort(edges.begin(), edges.end(), [](const Incidence& a, const Incidence& b) {
                return std::tuple(a.key(), a.entry) < std::tuple(b.key(), b.entry);
            });
            for (std::size_t i = 1; i < edges.size(); ++i) {
                if (edges[i].key() != edges[i - 1].key()) continue;
                const std::int32_t a = find(edges[i - 1].entry), b = find(edges[i].entry);
                root[std::max(a, b)] = std::min(a, b);
            }
            fan_of.resize(triangles.size());
            fan_sign.clear();
            next.clear();
            for (std::size_t entry = 0; entry < triangles.size(); ++entry) {
                const std::int32_t lowest = find(static_cast<std::int32_t>(entry));
                if (lowest == static_cast<std::int32_t>(entry)) {
                    fan_of[entry] = static_cast<std::int32_t>(fan_sign.size());
                    fan_sign.push_back(signs[triangles[entry]]);
                    next.push_back(0);
                } else {
                    fan_of[entry] = fan_of[lowest];
                }
                ++next[fan_of[entry]];
                // A face whose triangles fall into several fans takes the first that has UV area.
                std::int32_t& fan =
                    data.corner_fan[corner_at(triangles[entry], static_cast<std::int32_t>(vertex))];
                const bool better = fan >= 0 && fan_sign[fan] == 0 && signs[triangles[entry]] != 0;
                if (fan < 0 || better) fan = fan_of[entry];
            }
            first_fan[vertex + 1] = static_cast<std::int32_t>(fan_sign.size());
            std::exclusive_scan(next.begin(), next.end(), next.begin(),
                                data.vertex_triangles.offsets[vertex]);
            for (std::size_t entry = 0; entry < triangles.size(); ++entry) {
                const bool is_lowest = root[entry] == static_cast<std::int32_t>(entry);
                data.listed[next[fan_of[entry]]++] =
                    is_lowest ? ~triangles[entry] : triangles[entry];
            }
        }
    });
    data.report.seam_vertices = std::count_if(first_fan.begin(), first_fan.end(),
                                              [](std::int32_t fans) { return fans > 1; });
    std::inclusive_scan(first_fan.begin(), first_fan.end(), first_fan.begin());

    data.fans.offsets.reserve(static_cast<std::size_t>(first_fan.back()) + 1);
    for (std::size_t i = 0; i < data.listed.size(); ++i) {
        if (data.listed[i] >= 0) continue;
        data.listed[i] = ~data.listed[i];
        data.fans.offsets.push_back(static_cast<std::int32_t>(i));
    }
    data.fans.offsets.push_back(static_cast<std::int32_t>(data.listed.size()));
    data.fans.triangles = data.listed;
    for (std::size_t corner = 0; corner < data.corner_count; ++corner)
        if (data.corner_fan[corner] >= 0)
            data.corner_fan[corner] += first_fan[mesh.corner_vert[corner]];
}

}  // namespace

RestState::RestState(const MeshView& mesh, std::span<const Vec3f> positions)
    : data_(std::make_unique<Data>()) {
    validate(mesh);
    validate_positions(mesh, positions, "rest");
    Data& data = *data_;
    data.corner_count = mesh.corner_vert.size();
    data.vertex_count = mesh.vertex_count;
    data.has_uv = mesh.has_uv();
    prepare_triangles(mesh, positions, data);
    list_triangles_of_vertices(data);
    for (std::size_t i = 0; i < data.state.size(); ++i) {
        const TriangleState state = data.state[i];
        if (state != TriangleState::regular) data.irregular.push_back(static_cast<std::int32_t>(i));
        data.report.degenerate_triangles += state == TriangleState::no_area;
        data.report.no_uv_triangles += data.has_uv && state == TriangleState::no_uv;
    }
    if (!data.has_uv) return;
    const std::vector<signed char> signs = uv_signs(mesh);
    data.report.mirrored_triangles = std::count(signs.begin(), signs.end(), -1);
    prepare_fans(mesh, signs, data);
}

RestState::~RestState() = default;
RestState::RestState(RestState&&) noexcept = default;
RestState& RestState::operator=(RestState&&) noexcept = default;

const RestReport& RestState::report() const { return data_->report; }
std::size_t RestState::triangle_count() const { return data_->vertices.size(); }
std::size_t RestState::corner_count() const { return data_->corner_count; }
std::size_t RestState::vertex_count() const { return data_->vertex_count; }
bool RestState::has_uv() const { return data_->has_uv; }

}  // namespace ltmd::inline v0
