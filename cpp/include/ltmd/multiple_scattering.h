// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <utility>

#include "ltmd/masking.h"
#include "ltmd/visible_normals_mean.h"

/// What light does after its first reflection by mirror-like microfacets (masking-shadowing,
/// section 7, "Multiple Scattering").
namespace ltmd::inline v0 {

/// The part of the light from wo that leaves the surface after one reflection where F = 1: the
/// integral of brdf |wi_z| over wi, in [0, 1] (the second integral of eq. 104).
template <MicrofacetDistribution D, std::floating_point Real = typename D::Real>
Real single_scattering_albedo(const D& d, const Direction<Real>& wo,
                              MaskingModel model = MaskingModel::height_correlated,
                              int points = 32) {
    if (!(wo.z > 0)) return 0;
    const Real mean = visible_normals_mean(d, wo, points, [&](const Direction<Real>& m) {
        const Real cosine = 2 * dot(wo, m);
        const Direction<Real> wi{cosine * m.x - wo.x, cosine * m.y - wo.y, cosine * m.z - wo.z};
        return wi.z > 0 ? G2(d, wi, wo, m, model) : Real{0};
    });
    return mean * (d.projected_area(wo) / wo.z);
}

/// The same for arrays, on thread_count() threads. Throws InvalidInput unless all have one length.
template <std::floating_point Real>
LTMD_API void single_scattering_albedo(const AnyDistribution<Real>& d,
                                       std::span<const Direction<Real>> wo, MaskingModel model,
                                       int points, std::span<Real> out);

/// The mean of fresnel(wo.m) over the microfacets that wo sees (eq. 105).
template <MicrofacetDistribution D, std::invocable<typename D::Real> Fresnel,
          std::floating_point Real = typename D::Real>
Real average_visible_fresnel(const D& d, const Direction<Real>& wo, const Fresnel& fresnel,
                             int points = 32) {
    return visible_normals_mean(d, wo, points,
                                [&](const Direction<Real>& m) { return fresnel(dot(wo, m)); });
}

/// The light that leaves after two reflections or more, for F = 1. Its energy follows from eq. 104;
/// of its shape the paper says only that it is simple. Here it is E(wi) E(wo) / (pi E), with E the
/// mean over directions: the one product of two functions that is reciprocal and has that energy.
template <MicrofacetDistribution D>
class MultipleScattering {
public:
    using Real = typename D::Real;

    explicit MultipleScattering(D d, MaskingModel model = MaskingModel::height_correlated,
                                int points = 32)
        : d_(std::move(d)), model_(model), points_(points) {
        // Directions with density cos / pi.
        double sum = 0;
        for (int i = 0; i < points; ++i)
            for (int j = 0; j < points; ++j) {
                const Real u = static_cast<Real>((i + 0.5) / points);
                const Real phi = static_cast<Real>(2 * std::numbers::pi * ((j + 0.5) / points));
                const Real sine = std::sqrt(u);
                sum += energy({sine * std::cos(phi), sine * std::sin(phi), std::sqrt(1 - u)});
            }
        mean_energy_ = static_cast<Real>(sum / (static_cast<double>(points) * points));
    }

    /// The part of the light from w that is reflected more than once, in [0, 1] (eq. 104); 0 for
    /// w_z <= 0.
    Real energy(const Direction<Real>& w) const {
        if (!(w.z > 0)) return 0;
        return std::max(Real{0}, 1 - single_scattering_albedo(d_, w, model_, points_));
    }
    /// energy() averaged over diffuse light.
    Real mean_energy() const { return mean_energy_; }

    /// Per steradian; integrates with cos to energy(wo), so that together with one reflection it
    /// passes the white furnace (eq. 102, 103). 0 unless wi_z > 0 and wo_z > 0.
    Real brdf(const Direction<Real>& wi, const Direction<Real>& wo) const {
        if (!(mean_energy_ > 0)) return 0;
        return std::numbers::inv_pi_v<Real> * energy(wi) * (energy(wo) / mean_energy_);
    }

private:
    D d_;
    MaskingModel model_;
    int points_;
    Real mean_energy_ = 0;
};

}  // namespace ltmd::inline v0
