// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

/// The fraction of unpolarised light that a smooth interface reflects, in [0, 1]. `cosine` is that
/// of the angle between the light and the interface's normal, which points to the side above.
namespace ltmd::inline v0 {

/// Of an interface between two dielectrics, by Fresnel's equations. eta: the refractive index below
/// over that above, greater than 0. cosine in [-1, 1]; light arrives from below where it is
/// negative. 1 at total internal reflection.
template <std::floating_point Real>
Real fresnel_dielectric(Real cosine, Real eta) {
    if (eta == 1) return 0;
    const Real index = cosine < 0 ? 1 / eta : eta;
    const Real c = std::abs(cosine);
    const Real t2 = 1 - (1 - c) * (1 + c) / (index * index);
    if (!(t2 > 0)) return 1;
    const Real t = std::sqrt(t2);
    const Real s = (c - index * t) / (c + index * t);
    const Real p = (index * c - t) / (index * c + t);
    return (s * s + p * p) / 2;
}

/// Of a conductor with the complex refractive index eta + i k relative to the side above, eta
/// greater than 0 and k at least 0. The sign of the cosine is ignored.
template <std::floating_point Real>
Real fresnel_conductor(Real cosine, Real eta, Real k) {
    const Real c = std::min(std::abs(cosine), Real{1});
    const Real s2 = (1 - c) * (1 + c);
    // a + i b is the index times the cosine of the refracted wave: its square is q + 2 i eta k.
    const Real q = (eta - k) * (eta + k) - s2;
    const Real product = eta * k;
    const Real r = std::hypot(q, 2 * product);
    if (!(r > 0)) return eta == 1 ? Real{0} : Real{1};
    // The smaller of a^2 and b^2 by their product, without cancellation.
    const Real larger = (r + std::abs(q)) / 2, smaller = product * (product / larger);
    const Real a = std::sqrt(q > 0 ? larger : smaller), b2 = q > 0 ? smaller : larger;
    const auto squares = [](Real real, Real imaginary2) { return real * real + imaginary2; };
    const Real s = squares(a - c, b2) / squares(a + c, b2);
    const Real p = squares(a * c - s2, b2 * c * c) / squares(a * c + s2, b2 * c * c);
    return s * (1 + p) / 2;
}

/// Schlick's approximation from the reflectance f0 at normal incidence. The sign of the cosine is
/// ignored.
template <std::floating_point Real>
Real fresnel_schlick(Real cosine, Real f0) {
    const Real x = std::max(Real{0}, 1 - std::abs(cosine));
    return f0 + (1 - f0) * (x * x) * (x * x) * x;
}

/// Schlick's approximation with an edge tint: at the cosine 1/7, about 82 degrees, the reflectance
/// is `tint` times Schlick's. Clamped to 0, which a dark tint on a small f0 falls below.
template <std::floating_point Real>
Real fresnel_f82(Real cosine, Real f0, Real tint) {
    constexpr Real peak = Real{1} / 7;
    const Real c = std::min(std::abs(cosine), Real{1});
    const auto shape = [](Real x) {
        const Real y = 1 - x;
        return x * (y * y) * (y * y) * (y * y);
    };
    const Real drop = fresnel_schlick(peak, f0) * (1 - tint) / shape(peak);
    return std::clamp(fresnel_schlick(c, f0) - drop * shape(c), Real{0}, Real{1});
}

}  // namespace ltmd::inline v0
