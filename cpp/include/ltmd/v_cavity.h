// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/slope_distribution.h"

/// The V-cavity microsurface: grooves with two facets m and m' = (-m_x, -m_y, m_z), each pair a
/// surface of its own (masking-shadowing, section 4.2). The distribution must be symmetric,
/// D(m) = D(m'): every centred distribution of this library, under any M.
namespace ltmd::inline v0 {

/// The visible fraction of the facets m, for v_z > 0 and v.m > 0 (masking-shadowing, eq. 49).
template <std::floating_point Real>
Real v_cavity_G1(const Direction<Real>& v, const Direction<Real>& m) {
    return std::min(Real{1}, 2 * m.z * v.z / dot(v, m));
}

/// The density of v_cavity_sample_visible(), G1(v, m) max(0, v.m) D(m) / v_z, per steradian; 0 for
/// v_z <= 0 (masking-shadowing, eq. 50).
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real v_cavity_pdf_visible(const D& d, const Direction<Real>& v, const Direction<Real>& m) {
    const Real facing = dot(v, m);
    if (!(v.z > 0 && m.z > 0 && facing > 0)) return 0;
    return d.D(m) * std::min(facing / v.z, 2 * m.z);
}

/// A normal visible from v: of a pair drawn from D(m) m_z, one by their projected areas. `choice`
/// is a third random number, uniform in [0, 1].
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Direction<Real> v_cavity_sample_visible(const D& d, const Direction<Real>& v,
                                        const Uniform<Real>& u, Real choice) {
    const Direction<Real> m = d.sample(u), other{-m.x, -m.y, m.z};
    const Real area = std::max(Real{0}, dot(v, m)), other_area = std::max(Real{0}, dot(v, other));
    return choice * (area + other_area) < area ? m : other;
}

}  // namespace ltmd::inline v0
