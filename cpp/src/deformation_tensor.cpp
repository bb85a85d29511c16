// SPDX-License-Identifier: Apache-2.0
// This work is based on: microsurface-transformations, section 5.1, in the form of the left
// Cauchy-Green tensor.
#include "ltmd/deformation_tensor.h"

#include <cmath>
#include <memory>
#include <string>

#include "ltmd/errors.h"
#include "parallel.h"
#include "rest_state_data.h"
#include "vector_math.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 12;

/// A deformed face: E = [eu ev] in space, its unit normal (zero without area) and the angles at its
/// corners.
struct Face {
    V3d eu, ev, normal;
    double angle[3];
};

double angle_between(const V3d& a, const V3d& b) {
    return std::atan2(a.cross(b).length(), a.dot(b));
}

Face deformed_face(const std::array<std::int32_t, 3>& vertex, std::span<const Vec3f> deformed,
                   const std::array<double, 4>& inverse_rest) {
    const V3d p0 = to_double(deformed[vertex[0]]), p1 = to_double(deformed[vertex[1]]),
              p2 = to_double(deformed[vertex[2]]);
    const V3d d1 = p1 - p0, d2 = p2 - p0, cross = d1.cross(d2);
    if (has_no_area(d1, d2, cross)) return {};
    return {d1 * inverse_rest[0] + d2 * inverse_rest[2],
            d1 * inverse_rest[1] + d2 * inverse_rest[3],
            cross.normalized(),
            {angle_between(d1, d2), angle_between(d2 - d1, -d1), angle_between(-d2, d1 - d2)}};
}

/// `v` turned by the smallest rotation that takes unit vector `from` to unit vector `to`.
V3d turn(const V3d& v, const V3d& from, const V3d& to) {
    const V3d axis = from.cross(to);
    const double cosine = from.dot(to);
    // Opposite normals span one plane: nothing to turn.
    if (cosine < -1 + 1e-12) return v;
    return v * cosine + axis.cross(v) + axis * (axis.dot(v) / (1 + cosine));
}

}  // namespace

void deformation_tensor(const RestState& rest, std::span<const Vec3f> deformed,
                        std::span<SymmetricTensor> out) {
    const RestState::Data& data = rest.data();
    validate_positions({{}, {}, {}, static_cast<std::int32_t>(data.vertex_count)}, deformed,
                       "deformed");
    if (out.size() != data.vertex_count)
        throw InvalidInput("out has " + std::to_string(out.size()) + " entries; the mesh has " +
                           std::to_string(data.vertex_count) + " vertices");
    const auto faces = std::make_unique<Face[]>(data.vertices.size());
    parallel_for(data.vertices.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            faces[i] = data.state[i] == TriangleState::no_area
                           ? Face{}
                           : deformed_face(data.vertices[i], deformed,
                                           {data.inverse_rest[0][i], data.inverse_rest[1][i],
                                            data.inverse_rest[2][i], data.inverse_rest[3][i]});
    });
    parallel_for(data.vertex_count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const auto triangles = data.vertex_triangles[vertex];
            V3d normal(0);
            for (std::int32_t triangle : triangles) {
                int k = 0;
                while (data.vertices[triangle][k] != static_cast<std::int32_t>(vertex)) ++k;
                normal += faces[triangle].normal * faces[triangle].angle[k];
            }
            normal.normalize();
            double sum[6] = {}, weight = 0;
            for (std::int32_t triangle : triangles) {
                const Face& face = faces[triangle];
                if (face.normal.length2() == 0) continue;
                const bool flat = normal.length2() == 0;
                const V3d eu = flat ? face.eu : turn(face.eu, face.normal, normal);
                const V3d ev = flat ? face.ev : turn(face.ev, face.normal, normal);
                const double area = data.weight[triangle];
                constexpr int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
                for (int k = 0; k < 6; ++k)
                    sum[k] += area * (eu[row[k]] * eu[column[k]] + ev[row[k]] * ev[column[k]]);
                weight += area;
            }
            out[vertex] = {1, 1, 1, 0, 0, 0};
            if (weight > 0)
                for (int k = 0; k < 6; ++k) out[vertex][k] = static_cast<float>(sum[k] / weight);
        }
    });
}

void project_tensor(std::span<const SymmetricTensor> tensor, std::span<const Vec3f> x,
                    std::span<const Vec3f> y, std::span<Tension> out) {
    if (x.size() != tensor.size() || y.size() != tensor.size() || out.size() != tensor.size())
        throw InvalidInput("tensor, x, y and out have " + std::to_string(tensor.size()) + ", " +
                           std::to_string(x.size()) + ", " + std::to_string(y.size()) + " and " +
                           std::to_string(out.size()) + " entries; they must be equal");
    parallel_for(tensor.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const SymmetricTensor& b = tensor[i];
            const auto times = [&](const V3d& v) {
                return V3d(b[0] * v.x + b[3] * v.y + b[4] * v.z,
                           b[3] * v.x + b[1] * v.y + b[5] * v.z,
                           b[4] * v.x + b[5] * v.y + b[2] * v.z);
            };
            const V3d u = to_double(x[i]), v = to_double(y[i]);
            const double c11 = u.dot(times(u)), c12 = u.dot(times(v)), c22 = v.dot(times(v));
            const Gram c =
                clamp_stretch({c11, c12, c22, std::sqrt(std::max(0.0, c11 * c22 - c12 * c12))});
            const double t22 = std::sqrt(c.c22);
            out[i] = {static_cast<float>(c.root_det / t22), static_cast<float>(c.c12 / t22),
                      static_cast<float>(t22)};
        }
    });
}

}  // namespace ltmd::inline v0
