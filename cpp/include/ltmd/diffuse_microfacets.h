// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/masking.h"
#include "ltmd/visible_normals_mean.h"

namespace ltmd::inline v0 {

/// Light reflected once from wi to wo by Lambertian microfacets of albedo 1, per steradian: the
/// integral of <wi,m> <wo,m> G2 D(m) over normals, over pi wi_z wo_z (masking-shadowing, eq. 31);
/// 0 unless wi_z > 0 and wo_z > 0. By points x points visible normals from either direction, so it
/// is reciprocal.
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real diffuse_brdf(const D& d, const Direction<Real>& wi, const Direction<Real>& wo,
                  MaskingModel model = MaskingModel::height_correlated, int points = 32) {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    // <wo,m> D(m) over the facing area is the density of what wo sees.
    const auto from = [&](const Direction<Real>& v, const Direction<Real>& other) {
        const Real mean = visible_normals_mean(d, v, points, [&](const Direction<Real>& m) {
            return std::max(Real{0}, dot(other, m)) * G2(d, wi, wo, m, model);
        });
        return mean * (d.projected_area(v) / v.z) / other.z;
    };
    return std::numbers::inv_pi_v<Real> / 2 * (from(wo, wi) + from(wi, wo));
}

/// |wi_z| times the same with the masking of wo alone, wi above or below the surface: over all
/// directions wi it integrates to 1 for a masking model that conserves the visible area
/// (masking-shadowing, eq. 37).
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real diffuse_weak_furnace(const D& d, const Direction<Real>& wi, const Direction<Real>& wo,
                          MaskingModel model = MaskingModel::height_correlated, int points = 32) {
    if (!(wo.z > 0)) return 0;
    const Real mean = visible_normals_mean(d, wo, points, [&](const Direction<Real>& m) {
        return std::max(Real{0}, dot(wi, m)) * G1(d, wo, m, model);
    });
    return std::numbers::inv_pi_v<Real> * mean * (d.projected_area(wo) / wo.z);
}

/// The same for arrays, on thread_count() threads. Throws InvalidInput unless all have one length.
template <std::floating_point Real>
LTMD_API void diffuse_brdf(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
                           std::span<const Direction<Real>> wo, MaskingModel model, int points,
                           std::span<Real> out);
template <std::floating_point Real>
LTMD_API void diffuse_weak_furnace(const AnyDistribution<Real>& d,
                                   std::span<const Direction<Real>> wi,
                                   std::span<const Direction<Real>> wo, MaskingModel model,
                                   int points, std::span<Real> out);

}  // namespace ltmd::inline v0
