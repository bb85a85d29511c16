// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/masking.h"

/// Smith's masking of microfacets at one height; its mean over all heights is that of masking.h
/// (masking-shadowing, appendix B). m is a unit normal with m_z > 0.
namespace ltmd::inline v0 {

/// How heights are distributed. Masking depends on the distribution only through the fraction of
/// the surface below a height.
enum class Heights {
    uniform,   // in [-1, 1]
    gaussian,  // of standard deviation 1
};

/// The fraction of the surface below the height h, in [0, 1].
template <std::floating_point Real>
Real fraction_below(Heights heights, Real h) {
    if (heights == Heights::uniform) return std::clamp((1 + h) / 2, Real{0}, Real{1});
    return std::erfc(-h / std::numbers::sqrt2_v<Real>) / 2;
}

/// The fraction of the microfacets m that v sees, of those at a height with `below` of the surface
/// below it: below^Lambda(v), or what is above it for a v below the surface (eq. 126-128).
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real G1_at_height(const D& d, const Direction<Real>& v, const Direction<Real>& m, Real below) {
    const Direction<Real> w = upper(v);
    if (!(w.z > 0 && m.z > 0 && dot(w, m) > 0)) return 0;
    return std::pow(v.z < 0 ? 1 - below : below, bounded_lambda(d, w));
}

/// The fraction that both wi and wo see (eq. 130).
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real G2_at_height(const D& d, const Direction<Real>& wi, const Direction<Real>& wo,
                  const Direction<Real>& m, Real below) {
    return G1_at_height(d, wi, m, below) * G1_at_height(d, wo, m, below);
}

}  // namespace ltmd::inline v0
