// SPDX-License-Identifier: Apache-2.0
#include "ltmd/diffuse_microfacets.h"

#include "for_items.h"

namespace ltmd::inline v0 {

template <std::floating_point Real>
void diffuse_brdf(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
                  std::span<const Direction<Real>> wo, MaskingModel model, int points,
                  std::span<Real> out) {
    for_items<16>(
        out, [&](auto& i, auto& o) { return diffuse_brdf(d, i, o, model, points); }, wi, wo);
}
template <std::floating_point Real>
void diffuse_weak_furnace(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
                          std::span<const Direction<Real>> wo, MaskingModel model, int points,
                          std::span<Real> out) {
    for_items<16>(
        out, [&](auto& i, auto& o) { return diffuse_weak_furnace(d, i, o, model, points); }, wi,
        wo);
}

template <class Real>
using Directions = std::span<const Direction<Real>>;
template LTMD_API void diffuse_brdf<float>(const AnyDistribution<float>&, Directions<float>,
                                           Directions<float>, MaskingModel, int, std::span<float>);
template LTMD_API void diffuse_brdf<double>(const AnyDistribution<double>&, Directions<double>,
                                            Directions<double>, MaskingModel, int,
                                            std::span<double>);
template LTMD_API void diffuse_weak_furnace<float>(const AnyDistribution<float>&, Directions<float>,
                                                   Directions<float>, MaskingModel, int,
                                                   std::span<float>);
template LTMD_API void diffuse_weak_furnace<double>(const AnyDistribution<double>&,
                                                    Directions<double>, Directions<double>,
                                                    MaskingModel, int, std::span<double>);

}  // namespace ltmd::inline v0
