// SPDX-License-Identifier: Apache-2.0
#include "ltmd/microfacet_brdf.h"

#include "for_items.h"

namespace ltmd::inline v0 {

template <std::floating_point Real>
void brdf(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
          std::span<const Direction<Real>> wo, MaskingModel model, std::span<Real> out) {
    const auto mirror = [](Real) { return Real{1}; };
    for_items(out, [&](auto& i, auto& o) { return brdf(d, i, o, mirror, model); }, wi, wo);
}
template <std::floating_point Real>
void btdf(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
          std::span<const Direction<Real>> wo, Real eta, MaskingModel model, std::span<Real> out) {
    for_items(out, [&](auto& i, auto& o) { return btdf(d, i, o, eta, model); }, wi, wo);
}

template <class Real>
using Directions = std::span<const Direction<Real>>;
template LTMD_API void brdf<float>(const AnyDistribution<float>&, Directions<float>,
                                   Directions<float>, MaskingModel, std::span<float>);
template LTMD_API void brdf<double>(const AnyDistribution<double>&, Directions<double>,
                                    Directions<double>, MaskingModel, std::span<double>);
template LTMD_API void btdf<float>(const AnyDistribution<float>&, Directions<float>,
                                   Directions<float>, float, MaskingModel, std::span<float>);
template LTMD_API void btdf<double>(const AnyDistribution<double>&, Directions<double>,
                                    Directions<double>, double, MaskingModel, std::span<double>);

}  // namespace ltmd::inline v0
