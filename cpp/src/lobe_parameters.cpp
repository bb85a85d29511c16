// SPDX-License-Identifier: Apache-2.0
// This work is based on: microsurface-transformations, eq. 9, 29-31 and section 4.1.
#include "ltmd/lobe_parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ltmd/errors.h"
#include "parallel.h"
#include "text.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 12;

/// T_s = V^s Rot(s phi) with the polar decomposition T = V Rot(phi).
Matrix2 strengthened(const Tension& t, double strength) {
    const Matrix2 full = {t[0], t[1], 0, t[2]};
    if (strength == 1) return full;
    // The eigenvalues of T T^T are the squared principal stretches.
    const double xx = full.xx * full.xx + full.xy * full.xy, xy = full.xy * full.yy,
                 yy = full.yy * full.yy;
    const double largest = (xx + yy) / 2 + std::hypot((xx - yy) / 2, xy);
    const double area = full.xx * full.yy;
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    const double a = std::pow(largest, strength / 2),
                 b = std::pow(area / largest * area, strength / 2);
    const double c = std::cos(angle), s = std::sin(angle);
    const Matrix2 stretch = {a * c * c + b * s * s, (a - b) * c * s, (a - b) * c * s,
                             a * s * s + b * c * c};
    return stretch * rotation_matrix(strength * std::atan2(-full.xy, full.xx + full.yy));
}

/// A symmetric positive matrix; its determinant is kept apart, as the difference would cancel.
struct Sigma {
    double xx, xy, yy, determinant;
};

Sigma transformed(const Tension& t, const Lobe& lobe) {
    const Matrix2 ts = strengthened(t, lobe.strength);
    // det T_s = (det T)^s, also where its entries cancel.
    const double area = std::pow(double{t[0]} * t[2], lobe.strength);
    const double heights =
        lobe.height_response == 0 ? 1 : std::pow(area, -2 * lobe.height_response);
    const Matrix2 m = ts * lobe.m0;
    const double det = area * determinant(lobe.m0);
    // M^-1 with its rows scaled by the alphas: Sigma' is its Gram matrix.
    const double x0 = lobe.alpha_x * m.yy / det, x1 = -lobe.alpha_x * m.xy / det,
                 y0 = -lobe.alpha_y * m.yx / det, y1 = lobe.alpha_y * m.xx / det;
    const double root = heights * lobe.alpha_x * lobe.alpha_y / det;
    return {heights * (x0 * x0 + y0 * y0), heights * (x0 * x1 + y0 * y1),
            heights * (x1 * x1 + y1 * y1), root * root};
}

float narrowed(double value) {
    constexpr double limit = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -limit, limit));
}

struct Principal {
    float smaller, larger;
    double angle;  ///< Of the smaller, in [0, pi].
};

Principal principal(const Sigma& s) {
    const double difference = std::hypot((s.xx - s.yy) / 2, s.xy);
    const double largest = (s.xx + s.yy) / 2 + difference;
    const float larger = narrowed(std::sqrt(largest));
    // Within rounding of float the axes are noise.
    if (!(difference > 1e-7 * largest)) return {larger, larger, 0};
    const float smaller = narrowed(std::sqrt(s.determinant / largest));
    return {std::min(smaller, larger), larger,
            std::atan2(2 * s.xy, s.xx - s.yy) / 2 + std::numbers::pi / 2};
}

template <class Item>
void check(std::span<const Tension> t, const Lobe& lobe, std::span<Item> out) {
    if (out.size() != t.size())
        throw InvalidInput(text("out has ", out.size(), " entries; t has ", t.size()));
    validate(lobe);
    for (std::size_t i = 0; i < t.size(); ++i)
        if (!(t[i][0] > 0 && t[i][2] > 0 && std::isfinite(t[i][0] + t[i][2]) &&
              std::isfinite(t[i][1])))
            throw InvalidInput(text("tension ", i, " is (", t[i][0], ", ", t[i][1], ", ", t[i][2],
                                    "); it must be finite with t11 and t22 above 0"));
}

}  // namespace

void validate(const Lobe& lobe) {
    if (!(lobe.alpha_x > 0 && lobe.alpha_y > 0 && std::isfinite(lobe.alpha_x + lobe.alpha_y)))
        throw InvalidInput(
            text("alpha is (", lobe.alpha_x, ", ", lobe.alpha_y, "); both must be above 0"));
    require_invertible(lobe.m0, "M0");
    if (!(lobe.strength >= 0 && std::isfinite(lobe.strength)))
        throw InvalidInput(text("strength is ", lobe.strength, "; it must be 0 or more"));
    if (!std::isfinite(lobe.height_response))
        throw InvalidInput(
            text("height_response is ", lobe.height_response, "; it must be finite"));
}

void alpha2(std::span<const Tension> t, const Lobe& lobe, std::span<Vec3f> out) {
    check(t, lobe, out);
    parallel_for(t.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Sigma s = transformed(t[i], lobe);
            out[i] = {narrowed(s.xx), narrowed(s.xy), narrowed(s.yy)};
        }
    });
}

void lobe_parameters(std::span<const Tension> t, const Lobe& lobe, std::span<Vec3f> out) {
    check(t, lobe, out);
    parallel_for(t.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Principal p = principal(transformed(t[i], lobe));
            const auto angle = static_cast<float>(p.angle);
            out[i] = {p.smaller, p.larger, angle < std::numbers::pi_v<float> ? angle : 0};
        }
    });
}

void roughness(std::span<const Tension> t, const Lobe& lobe, std::span<std::array<float, 4>> out) {
    check(t, lobe, out);
    parallel_for(t.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Principal p = principal(transformed(t[i], lobe));
            out[i] = {p.smaller, p.larger, static_cast<float>(std::cos(2 * p.angle)),
                      static_cast<float>(std::sin(2 * p.angle))};
        }
    });
}

}  // namespace ltmd::inline v0
