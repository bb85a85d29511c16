// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "ltmd/elementary.h"
#include "ltmd/slope_distribution.h"

/// Visible normals of lobes whose slopes are of scale 1; views and normals of other lobes are
/// stretched to these (microsurface-transformations, eq. 28).
namespace ltmd::inline v0 {

/// Shares of the lobes of a mixture, of which one is picked.
template <std::floating_point Real, std::size_t capacity>
class LobeShares {
public:
    /// Lobes come in fours, so that loops over them vectorise; the last may be of weight 0.
    static constexpr std::size_t lanes = 4;
    static_assert(capacity % lanes == 0);

    /// Takes share(i) of the lobes i < count, `count` divisible by 4.
    template <class Share>
    LobeShares(std::size_t count, const Share& share) : fours_(count / lanes) {
        for (std::size_t i = 0; i < count; ++i) share_[i] = share(i);
        for (std::size_t i = 0; i < fours_; ++i) {
            const Real* s = &share_[lanes * i];
            total_ += four_[i] = (s[0] + s[1]) + (s[2] + s[3]);
        }
    }

    Real total() const { return total_; }
    Real operator[](std::size_t i) const { return share_[i]; }

    struct Pick {
        std::size_t lobe;
        Real place;
    };
    /// The lobe in whose share of the total u in [0, 1] falls, and its place there, in [0, 1]. The
    /// total must be positive.
    Pick pick(Real u) const {
        Real rest = u * total_;
        std::size_t four = 0;
        while (four + 1 < fours_ && rest >= four_[four]) rest -= four_[four++];
        const Real* s = &share_[lanes * four];
        const Real two = s[0] + s[1], three = two + s[2];
        std::size_t i = lanes * four + (rest >= s[0]) + (rest >= two) + (rest >= three);
        rest -= rest >= three ? three : rest >= two ? two : rest >= s[0] ? s[0] : Real{0};
        while (i > 0 && !(share_[i] > 0)) rest = share_[--i];
        return {i, std::min(rest / share_[i], Real{1})};
    }

private:
    std::size_t fours_;
    Real total_ = 0;
    std::array<Real, capacity> share_;
    std::array<Real, capacity / lanes> four_;
};

/// A point c of the spherical cap c_z >= lowest, uniform in [0, 1]^2 by area.
template <std::floating_point Real>
Direction<Real> sample_cap(Real lowest, const Uniform<Real>& u) {
    const auto [cosine, sine] = elementary::turn(u.x);
    // The lowest point of a sphere would reflect the pole to no normal at all.
    const Real share = std::max(1 - u.y, std::numeric_limits<Real>::epsilon());
    const Real z = share * (1 - lowest) + lowest;
    const Real radius = std::sqrt(std::max(Real{0}, (1 - z) * (1 + z)));
    return {radius * cosine, radius * sine, z};
}

/// A visible normal of a GGX lobe from the unit vector w (w_z >= 0), not normalised: the visible
/// half of a sphere's normals is a cap of reflected directions.
template <std::floating_point Real>
Direction<Real> sample_visible_ggx(const Direction<Real>& w, const Uniform<Real>& u) {
    const Direction<Real> c = sample_cap(-w.z, u);
    return {c.x + w.x, c.y + w.y, std::max(Real{0}, c.z + w.z)};
}

/// The visible normals of slopes with the density n - 1 over pi (1 + |slope|^2)^-n, n = 2 + extra,
/// extra 1 or 2, from the unit vector w (w_z >= 0); the result is not normalised.
///
/// Their density per steradian is proportional to max(0, w.m) m_z^(2 extra). With
/// m = (sin(a) cos(b), sin(b), cos(a) cos(b)), a in the plane of w and of the macrosurface normal,
/// it is cos(a)^(2 extra) cos(a - theta_w) times cos(b)^(2 extra + 2), so both angles are
/// independent. sin(b) is one coordinate of a point in the unit disc with density (1 - r^2)^extra;
/// the other, spread by its own distribution given sin(b), is a third uniform number for a.
template <std::floating_point Real>
Direction<Real> sample_visible_student(int extra, const Direction<Real>& w,
                                       const Uniform<Real>& u) {
    const Real r2 = 1 - (extra == 1 ? std::sqrt(1 - u.x) : std::cbrt(1 - u.x));
    const Real radius = std::sqrt(std::max(Real{0}, r2));
    const auto [cosine, sine] = elementary::turn(u.y);
    const Real sin_b = radius * cosine;
    const Real cos_b = std::sqrt(std::max(Real{0}, 1 - sin_b * sin_b));
    const Real e = cos_b > 0 ? std::clamp(radius * sine / cos_b, Real{-1}, Real{1}) : Real{0};
    const Real e2 = e * e;
    // The distribution function of (1 - e^2)^extra, in [0, 1].
    const Real third =
        extra == 1 ? Real{0.5} + e * (3 - e2) / 4 : Real{0.5} + e * (15 - e2 * (10 - 3 * e2)) / 16;

    const Real across = std::sqrt(w.x * w.x + w.y * w.y);
    // The integral of cos^(2 extra) cos(a - theta_w) up to a, with s = sin(a), c = cos(a) >= 0.
    const auto integral = [&](Real s, Real c) {
        const Real s2 = s * s, c3 = c * c * c;
        return extra == 1 ? (w.z * s * (3 - s2) - across * c3) / 3
                          : (w.z * s * (15 - s2 * (10 - 3 * s2)) - 3 * across * c3 * c * c) / 15;
    };
    const Real least = integral(-w.z, across), greatest = integral(1, 0);
    const Real wanted = least + third * (greatest - least);
    // In turns from the first visible angle, whose sine is -w_z, to at most that of a = pi / 2;
    // asin(z) <= pi / 2 z.
    Real low = 0, high = (1 + w.z) / 4, turns = high * std::sqrt(third) / 2;
    Real sin_a = -w.z, cos_a = across;
    constexpr Real precision = 4 * std::numeric_limits<Real>::epsilon();
    for (int step = 0; step < 16; ++step) {
        const auto [c, s] = elementary::turn(turns);
        cos_a = std::max(Real{0}, across * c + w.z * s);
        sin_a = cos_a > 0 ? across * s - w.z * c : Real{1};
        const Real error = integral(sin_a, cos_a) - wanted;
        if (std::abs(error) <= precision) break;
        (error > 0 ? high : low) = turns;
        const Real c2 = cos_a * cos_a;
        const Real slope = (extra == 1 ? c2 : c2 * c2) * (cos_a * w.z + sin_a * across);
        const Real newton = turns - error / (2 * std::numbers::pi_v<Real> * slope);
        turns = newton > low && newton < high ? newton : (low + high) / 2;
    }
    const Real s = sin_a * cos_b, c = cos_a * cos_b;
    if (!(across > 0)) return {s, sin_b, c};
    const Real x = w.x / across, y = w.y / across;
    return {x * s - y * sin_b, y * s + x * sin_b, c};
}

}  // namespace ltmd::inline v0
