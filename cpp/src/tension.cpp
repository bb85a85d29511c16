// SPDX-License-Identifier: Apache-2.0
// This work is based on: microsurface-transformations, section 5.1 and Fig. 7.
#include "ltmd/tension.h"

#include <cmath>
#include <memory>
#include <string>

#include "ltmd/errors.h"
#include "parallel.h"
#include "rest_state_data.h"
#include "vector_math.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 14;

Tension triangle_tension(const V3d& p0, const V3d& p1, const V3d& p2,
                         const std::array<double, 4>& inverse_rest) {
    // E = [d1 d2] R^-1: the deformed images of the rest frame's x and y.
    const V3d d1 = p1 - p0, d2 = p2 - p0;
    const V3d eu = d1 * inverse_rest[0] + d2 * inverse_rest[2];
    const V3d ev = d1 * inverse_rest[1] + d2 * inverse_rest[3];
    const Gram c = clamp_stretch({eu.length2(), eu.dot(ev), ev.length2(), eu.cross(ev).length()});
    const double t11 = std::sqrt(c.c11);
    return {static_cast<float>(t11), static_cast<float>(c.c12 / t11),
            static_cast<float>(c.root_det / t11)};
}

void per_triangle(const RestState::Data& data, std::span<const Vec3f> deformed, Tension* out) {
    parallel_for(data.vertices.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto& vertex = data.vertices[i];
            out[i] = data.state[i] == TriangleState::regular
                         ? triangle_tension(to_double(deformed[vertex[0]]),
                                            to_double(deformed[vertex[1]]),
                                            to_double(deformed[vertex[2]]), data.inverse_rest[i])
                         : identity_tension;
        }
    });
}

/// The mean of each list's triangles, weighted by rest area.
void average(const TriangleLists& lists, const RestState::Data& data, const Tension* of_triangle,
             Tension* out) {
    parallel_for(lists.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            double sum[3] = {0, 0, 0}, weight = 0;
            for (std::int32_t triangle : lists[i]) {
                const double area = data.area[triangle];
                for (int k = 0; k < 3; ++k) sum[k] += area * of_triangle[triangle][k];
                weight += area;
            }
            if (weight > 0)
                for (int k = 0; k < 3; ++k) out[i][k] = static_cast<float>(sum[k] / weight);
            else
                out[i] = identity_tension;
        }
    });
}

}  // namespace

std::size_t tension_count(const RestState& rest, Per per) {
    switch (per) {
        case Per::triangle:
            return rest.triangle_count();
        case Per::vertex:
            return rest.vertex_count();
        case Per::corner:
            break;
    }
    return rest.corner_count();
}

void tension(const RestState& rest, std::span<const Vec3f> deformed, Per per,
             std::span<Tension> out) {
    const RestState::Data& data = rest.data();
    if (!data.has_uv)
        throw InvalidInput(
            "the mesh has no UV map: tension needs one; use deformation_tensor without");
    validate_positions({{}, {}, {}, static_cast<std::int32_t>(data.vertex_count)}, deformed,
                       "deformed");
    if (out.size() != tension_count(rest, per))
        throw InvalidInput("out has " + std::to_string(out.size()) + " entries; this tension has " +
                           std::to_string(tension_count(rest, per)));
    if (per == Per::triangle) {
        per_triangle(data, deformed, out.data());
        return;
    }
    const auto of_triangle = std::make_unique_for_overwrite<Tension[]>(data.vertices.size());
    per_triangle(data, deformed, of_triangle.get());
    if (per == Per::vertex) {
        average(data.vertex_triangles, data, of_triangle.get(), out.data());
        return;
    }
    const auto of_fan = std::make_unique_for_overwrite<Tension[]>(data.fans.size());
    average(data.fans, data, of_triangle.get(), of_fan.get());
    parallel_for(out.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            out[i] = data.corner_fan[i] < 0 ? identity_tension : of_fan[data.corner_fan[i]];
    });
}

void tension_matrix(std::span<const Tension> t, std::span<std::array<float, 4>> out) {
    if (out.size() != t.size())
        throw InvalidInput("out has " + std::to_string(out.size()) + " entries; t has " +
                           std::to_string(t.size()));
    for (std::size_t i = 0; i < t.size(); ++i) out[i] = {t[i][0], t[i][1], 0, t[i][2]};
}

void stretch(std::span<const Tension> t, std::span<Vec3f> out) {
    if (out.size() != t.size())
        throw InvalidInput("out has " + std::to_string(out.size()) + " entries; t has " +
                           std::to_string(t.size()));
    parallel_for(t.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double a = t[i][0], b = t[i][1], d = t[i][2];
            // Singular values of an upper triangular matrix: half the sum and difference of two
            // lengths.
            const double sum = std::hypot(a + d, b), difference = std::hypot(a - d, b);
            const double largest = 0.5 * (sum + difference);
            out[i] = {static_cast<float>(largest),
                      static_cast<float>(largest > 0 ? std::abs(a * d) / largest : 0),
                      static_cast<float>(a * d)};
        }
    });
}

}  // namespace ltmd::inline v0
