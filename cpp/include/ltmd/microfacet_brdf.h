// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <span>

#include "ltmd/fresnel.h"
#include "ltmd/masking.h"

/// Reflection and refraction by mirror-like microfacets. wi points to where light comes from, wo to
/// where it goes; both are unit vectors on either side of the surface.
namespace ltmd::inline v0 {

/// The normal, h_z > 0, that mirrors wi to wo, of two directions on one side.
template <std::floating_point Real>
Direction<Real> reflection_normal(const Direction<Real>& wi, const Direction<Real>& wo) {
    return normalized(upper(Direction<Real>{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z}));
}

/// Light reflected, per steradian: F D G2 / (4 |wi_z| |wo_z|) (masking-shadowing, eq. 29); 0 for
/// directions on two sides or at the horizon. fresnel(cosine) is the reflectance, the cosine wi.h
/// negative for light from below.
template <MicrofacetDistribution D, std::invocable<typename D::Real> Fresnel,
          std::floating_point Real = typename D::Real>
Real brdf(const D& d, const Direction<Real>& wi, const Direction<Real>& wo, const Fresnel& fresnel,
          MaskingModel model = MaskingModel::height_correlated) {
    if (wi.z == 0 || wo.z == 0 || (wi.z > 0) != (wo.z > 0)) return 0;
    const Direction<Real> h = reflection_normal(wi, wo);
    return fresnel(dot(wi, h)) *
           (d.D(h) * G2(d, wi, wo, h, model) / (4 * std::abs(wi.z)) / std::abs(wo.z));
}

/// The normal, not normalised but with h_z >= 0, that refracts wi to wo on the other side; eta is
/// the refractive index below over that above. Its squared length is the denominator of the change
/// of solid angle, (eta_i wi.h + eta_o wo.h)^2.
template <std::floating_point Real>
Direction<Real> refraction_normal(const Direction<Real>& wi, const Direction<Real>& wo, Real eta) {
    const Real i = wi.z < 0 ? eta : Real{1}, o = wi.z < 0 ? Real{1} : eta;
    return upper(Direction<Real>{i * wi.x + o * wo.x, i * wi.y + o * wo.y, i * wi.z + o * wo.z});
}

/// Light refracted, per steradian, as radiance: |wi.h| |wo.h| eta_o^2 (1 - F) D G2 /
/// (|wi_z| |wo_z| (eta_i wi.h + eta_o wo.h)^2) (Walter et al. 2007, named by ellipsoid-ndf,
/// section 1). 0 for directions on one side or at the horizon, where no normal refracts one to
/// the other, and for eta = 1, where all light goes straight on. Swapping the directions gives the
/// value times (eta_i / eta_o)^2.
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real btdf(const D& d, const Direction<Real>& wi, const Direction<Real>& wo, Real eta,
          MaskingModel model = MaskingModel::height_correlated) {
    if (wi.z == 0 || wo.z == 0 || (wi.z > 0) == (wo.z > 0) || eta == 1) return 0;
    const Direction<Real> scaled = refraction_normal(wi, wo, eta);
    const Real length2 = dot(scaled, scaled);
    if (!(length2 > 0)) return 0;
    const Direction<Real> h = normalized(scaled);
    const Real g = G2(d, wi, wo, h, model);
    if (!(g > 0)) return 0;
    const Real cosine = dot(wi, h), eta_o = wi.z < 0 ? Real{1} : eta;
    return (1 - fresnel_dielectric(cosine, eta)) * std::abs(cosine * dot(wo, h)) *
           (eta_o * eta_o / length2) * (d.D(h) * g / std::abs(wi.z)) / std::abs(wo.z);
}

/// The same for arrays, on thread_count() threads, the BRDF with F = 1. Throws InvalidInput unless
/// all have one length.
template <std::floating_point Real>
LTMD_API void brdf(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
                   std::span<const Direction<Real>> wo, MaskingModel model, std::span<Real> out);
template <std::floating_point Real>
LTMD_API void btdf(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
                   std::span<const Direction<Real>> wo, Real eta, MaskingModel model,
                   std::span<Real> out);

}  // namespace ltmd::inline v0
