// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ltmd/slope_distribution.h"

/// Visible normals of lobes whose slopes are of scale 1; views and normals of other lobes are
/// stretched to these (microsurface-transformations, eq. 28).
namespace ltmd::inline v0 {

/// A point c of the spherical cap c_z >= lowest, uniform in [0, 1]^2 by area.
template <std::floating_point Real>
Direction<Real> sample_cap(Real lowest, const Uniform<Real>& u) {
    const Real phi = 2 * std::numbers::pi_v<Real> * u.x;
    const Real z = (1 - u.y) * (1 - lowest) + lowest;
    const Real sine = std::sqrt(std::max(Real{0}, (1 - z) * (1 + z)));
    return {sine * std::cos(phi), sine * std::sin(phi), z};
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
    const Real azimuth = 2 * std::numbers::pi_v<Real> * u.y;
    const Real sin_b = radius * std::cos(azimuth);
    const Real cos_b = std::sqrt(std::max(Real{0}, 1 - sin_b * sin_b));
    const Real e =
        cos_b > 0 ? std::clamp(radius * std::sin(azimuth) / cos_b, Real{-1}, Real{1}) : Real{0};
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
    Real low = std::asin(-w.z), high = std::numbers::pi_v<Real> / 2;
    Real a = low + (high - low) * std::sqrt(third) / 2;
    const Real precision = 2 * std::numeric_limits<Real>::epsilon() * (greatest - least);
    for (int step = 0; step < 40; ++step) {
        const Real s = std::sin(a), c = std::cos(a);
        const Real error = integral(s, c) - wanted;
        if (std::abs(error) <= precision) break;
        (error > 0 ? high : low) = a;
        const Real slope = (extra == 1 ? c * c : c * c * c * c) * (c * w.z + s * across);
        const Real newton = a - error / slope;
        a = newton > low && newton < high ? newton : (low + high) / 2;
    }
    const Real s = std::sin(a) * cos_b, c = std::max(Real{0}, std::cos(a) * cos_b);
    if (!(across > 0)) return {s, sin_b, c};
    const Real x = w.x / across, y = w.y / across;
    return {x * s - y * sin_b, y * s + x * sin_b, c};
}

}  // namespace ltmd::inline v0
