// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltmd/any_distribution.h"
#include "ltmd/beta_function.h"
#include "ltmd/v_cavity.h"

/// Masking, the fraction of microfacets of a normal m that a direction sees, and joint
/// masking-shadowing, the fraction that two directions see (masking-shadowing).
///
/// A direction w below the surface sees its other side: -w takes the place of w (ellipsoid-ndf,
/// eq. 7). m is a unit normal with m_z > 0.
namespace ltmd::inline v0 {

/// The first four are Smith's; with V-cavities they conserve the visible area
/// (masking-shadowing, table 3). The last three do not and are here to compare with.
enum class MaskingModel {
    separable,                    // masking and shadowing as if independent (eq. 98)
    height_correlated,            // both are rarer on high microfacets (eq. 99)
    direction_correlated,         // separable, alike in like azimuths (eq. 100)
    height_direction_correlated,  // height-correlated, alike in like azimuths (eq. 101)
    v_cavity,                     // grooves (eq. 49)
    implicit,                     // cancels the BRDF's denominator (eq. 55-57)
    schlick_smith,                // Schlick's rational function (section 4.3)
    kelemen,                      // Kelemen and Szirmay-Kalos' (eq. 58-60)
};

/// Smith's Lambda with a finite value where it grows beyond all bounds, at v_z = 0.
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real bounded_lambda(const D& d, const Direction<Real>& v) {
    constexpr Real bound = 1e30F;
    const Real lambda = v.z > 0 ? d.Lambda(v) : bound;
    return lambda < bound ? lambda : bound;
}

/// How little two directions share their masking: 0 in one azimuth, towards 1 for opposed ones
/// (masking-shadowing, section 6, van Ginneken's factor 4.41 phi / (4.41 phi + 1)).
template <std::floating_point Real>
Real azimuthal_independence(const Direction<Real>& a, const Direction<Real>& b) {
    const Real phi = std::atan2(std::abs(a.x * b.y - a.y * b.x), a.x * b.x + a.y * b.y);
    const Real x = static_cast<Real>(4.41) * phi;
    return x / (x + 1);
}

/// Schlick's v_z / (v_z + k (1 - v_z)). His k, sqrt(2/pi) times the RMS slope of a Gaussian
/// surface, is twice its mean slope upwards along v, which every distribution has: v_z Lambda at
/// v_z = 0.
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real schlick_smith_G1(const D& d, const Direction<Real>& v) {
    const Real across = std::hypot(v.x, v.y);
    if (!(across > 0)) return 1;
    constexpr Real horizon = 1e-10F;
    const Real k = 2 * horizon * d.Lambda({v.x / across, v.y / across, horizon});
    return v.z / (v.z + k * (1 - v.z));
}

/// The direction in whose masking w takes part: w itself, or -w for a w below the surface.
template <std::floating_point Real>
Direction<Real> upper(const Direction<Real>& w) {
    return w.z < 0 ? Direction<Real>{-w.x, -w.y, -w.z} : w;
}

/// The fraction of the microfacets m that v sees: 0 where they face away and at v_z = 0. In [0, 1]
/// except Kelemen's.
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real G1(const D& d, const Direction<Real>& v, const Direction<Real>& m, MaskingModel model) {
    const Direction<Real> w = upper(v);
    const Real facing = dot(w, m);
    if (!(w.z > 0 && m.z > 0 && facing > 0)) return 0;
    switch (model) {
        case MaskingModel::v_cavity:
            return v_cavity_G1(w, m);
        case MaskingModel::implicit:
            return w.z;
        case MaskingModel::schlick_smith:
            return schlick_smith_G1(d, w);
        case MaskingModel::kelemen:
            return w.z / facing;
        default:
            return 1 / (1 + bounded_lambda(d, w));
    }
}

/// The fraction of the microfacets m that both wi and wo see.
///
/// For two sides (refraction) the visible parts lie apart. Smith's height-correlated forms become
/// B(1 + Lambda_i, 1 + Lambda_o): low points are seen from below as high ones from above (the
/// integral of eq. 130, with the heights above in place of those below for one of both). V-cavities
/// give max(0, G1 + G1 - 1). Azimuths do not count, and the other models give the product.
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real G2(const D& d, const Direction<Real>& wi, const Direction<Real>& wo, const Direction<Real>& m,
        MaskingModel model) {
    using enum MaskingModel;
    const Direction<Real> i = upper(wi), o = upper(wo);
    const bool one_side = (wi.z < 0) == (wo.z < 0);
    if (model == height_correlated || model == height_direction_correlated) {
        if (!(i.z > 0 && o.z > 0 && m.z > 0 && dot(i, m) > 0 && dot(o, m) > 0)) return 0;
        const Real lambda_i = bounded_lambda(d, i), lambda_o = bounded_lambda(d, o);
        if (!one_side) return static_cast<Real>(beta_function(1. + lambda_i, 1. + lambda_o));
        if (model == height_correlated) return 1 / (1 + lambda_i + lambda_o);
        return 1 / (1 + std::max(lambda_i, lambda_o) +
                    azimuthal_independence(i, o) * std::min(lambda_i, lambda_o));
    }
    const Real g_i = G1(d, wi, m, model), g_o = G1(d, wo, m, model);
    if (one_side && model == v_cavity) return std::min(g_i, g_o);
    if (!one_side && model == v_cavity) return std::max(Real{0}, g_i + g_o - 1);
    if (one_side && model == direction_correlated) {
        const Real lambda = azimuthal_independence(i, o);
        return lambda * g_i * g_o + (1 - lambda) * std::min(g_i, g_o);
    }
    return g_i * g_o;
}

/// The same for arrays, on thread_count() threads: out[j] of item j. Throws InvalidInput unless all
/// have one length.
template <std::floating_point Real>
LTMD_API void G1(const AnyDistribution<Real>& d, std::span<const Direction<Real>> v,
                 std::span<const Direction<Real>> m, MaskingModel model, std::span<Real> out);
template <std::floating_point Real>
LTMD_API void G2(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
                 std::span<const Direction<Real>> wo, std::span<const Direction<Real>> m,
                 MaskingModel model, std::span<Real> out);

}  // namespace ltmd::inline v0
