// SPDX-License-Identifier: Apache-2.0
// This work is based on: microsurface-transformations, section 5.1 and Fig. 7.
#include "ltmd/tension.h"

#include <algorithm>
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
constexpr int block_size = 256;

// The widest vectors the machine has. Contraction is off, so all give the same bits. The choice is
// made while loading, before ThreadSanitizer is ready for it.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__)
#define LTMD_WIDE __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define LTMD_WIDE
#endif

/// A block of triangles, component by component.
struct Block {
    alignas(64) float p[9][block_size];  ///< x, y, z of the three deformed vertices.
    alignas(64) float t[3][block_size];
};

/// Fills block.t from block.p for `count` triangles; returns whether all stretches are in range.
/// E = [d1 d2] R^-1 holds the deformed images of the rest frame's x and y.
LTMD_WIDE bool evaluate(Block& block, const double* __restrict ixx, const double* __restrict ixy,
                        const double* __restrict iyx, const double* __restrict iyy, int count) {
    int out_of_range = 0;
    for (int i = 0; i < count; ++i) {
        double d1[3], d2[3], eu[3], ev[3];
        for (int k = 0; k < 3; ++k) {
            const double origin = block.p[k][i];
            d1[k] = block.p[3 + k][i] - origin;
            d2[k] = block.p[6 + k][i] - origin;
            eu[k] = d1[k] * ixx[i] + d2[k] * iyx[i];
            ev[k] = d1[k] * ixy[i] + d2[k] * iyy[i];
        }
        const double c11 = eu[0] * eu[0] + eu[1] * eu[1] + eu[2] * eu[2];
        const double c12 = eu[0] * ev[0] + eu[1] * ev[1] + eu[2] * ev[2];
        const double c22 = ev[0] * ev[0] + ev[1] * ev[1] + ev[2] * ev[2];
        const double x = eu[1] * ev[2] - eu[2] * ev[1], y = eu[2] * ev[0] - eu[0] * ev[2],
                     z = eu[0] * ev[1] - eu[1] * ev[0];
        const double det = x * x + y * y + z * z;
        out_of_range |= !is_in_stretch_range(c11 + c22, det);
        const float t11 = std::sqrt(static_cast<float>(c11));
        block.t[0][i] = t11;
        block.t[1][i] = static_cast<float>(c12) / t11;
        block.t[2][i] = std::sqrt(static_cast<float>(det)) / t11;
    }
    return !out_of_range;
}

Tension clamped_tension(const RestState::Data& data, std::span<const Vec3f> deformed,
                        std::size_t triangle) {
    const auto& vertex = data.vertices[triangle];
    const V3d p0 = to_double(deformed[vertex[0]]);
    const V3d d1 = to_double(deformed[vertex[1]]) - p0, d2 = to_double(deformed[vertex[2]]) - p0;
    const V3d eu = d1 * data.inverse_rest[0][triangle] + d2 * data.inverse_rest[2][triangle];
    const V3d ev = d1 * data.inverse_rest[1][triangle] + d2 * data.inverse_rest[3][triangle];
    const Gram c = clamp_stretch({eu.length2(), eu.dot(ev), ev.length2(), eu.cross(ev).length()});
    const double t11 = std::sqrt(c.c11);
    return {static_cast<float>(t11), static_cast<float>(c.c12 / t11),
            static_cast<float>(c.root_det / t11)};
}

/// Calls write(triangle, tension) for each triangle.
template <class Write>
void for_each_triangle(const RestState::Data& data, std::span<const Vec3f> deformed,
                       const Write& write) {
    parallel_for(data.vertices.size(), grain, [&](std::size_t begin, std::size_t end) {
        Block block;
        auto irregular = std::lower_bound(data.irregular.begin(), data.irregular.end(), begin);
        for (std::size_t first = begin; first < end; first += block_size) {
            const int count = static_cast<int>(std::min<std::size_t>(block_size, end - first));
            for (int i = 0; i < count; ++i)
                for (int k = 0; k < 3; ++k) {
                    const Vec3f& p = deformed[data.vertices[first + i][k]];
                    for (int axis = 0; axis < 3; ++axis) block.p[3 * k + axis][i] = p[axis];
                }
            const auto& inverse = data.inverse_rest;
            const bool in_range = evaluate(block, &inverse[0][first], &inverse[1][first],
                                           &inverse[2][first], &inverse[3][first], count);
            for (int i = 0; i < count; ++i) {
                Tension t = {block.t[0][i], block.t[1][i], block.t[2][i]};
                if (!in_range) t = clamped_tension(data, deformed, first + i);
                write(first + i, t);
            }
            for (; irregular != data.irregular.end() &&
                   static_cast<std::size_t>(*irregular) < first + count;
                 ++irregular)
                write(*irregular, identity_tension);
        }
    });
}

/// A tension times its weight, and the weight.
struct alignas(16) Weighted {
    float value[4];
};

/// The weighted mean of each list's triangles.
void average(const TriangleLists& lists, const Weighted* of_triangle, Tension* out) {
    parallel_for(lists.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            double sum[4] = {0, 0, 0, 0};
            for (std::int32_t triangle : lists[i])
                for (int k = 0; k < 4; ++k) sum[k] += of_triangle[triangle].value[k];
            const double scale = 1 / sum[3];
            for (int k = 0; k < 3; ++k) out[i][k] = static_cast<float>(sum[k] * scale);
            if (!(sum[3] > 0)) out[i] = identity_tension;
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
        for_each_triangle(data, deformed, [&](std::size_t i, const Tension& t) { out[i] = t; });
        return;
    }
    const auto of_triangle = std::make_unique_for_overwrite<Weighted[]>(data.vertices.size());
    for_each_triangle(data, deformed, [&](std::size_t i, const Tension& t) {
        const float w = data.weight[i];
        of_triangle[i] = {{w * t[0], w * t[1], w * t[2], w}};
    });
    if (per == Per::vertex) {
        average(data.vertex_triangles, of_triangle.get(), out.data());
        return;
    }
    const auto of_fan = std::make_unique_for_overwrite<Tension[]>(data.fans.size());
    average(data.fans, of_triangle.get(), of_fan.get());
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
