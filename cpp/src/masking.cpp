// SPDX-License-Identifier: Apache-2.0
#include "ltmd/masking.h"

#include "for_items.h"

namespace ltmd::inline v0 {

template <std::floating_point Real>
void G1(const AnyDistribution<Real>& d, std::span<const Direction<Real>> v,
        std::span<const Direction<Real>> m, MaskingModel model, std::span<Real> out) {
    for_items(out, [&](auto& a, auto& b) { return G1(d, a, b, model); }, v, m);
}
template <std::floating_point Real>
void G2(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wi,
        std::span<const Direction<Real>> wo, std::span<const Direction<Real>> m, MaskingModel model,
        std::span<Real> out) {
    for_items(out, [&](auto& i, auto& o, auto& n) { return G2(d, i, o, n, model); }, wi, wo, m);
}

template <class Real>
using Directions = std::span<const Direction<Real>>;
template LTMD_API void G1<float>(const AnyDistribution<float>&, Directions<float>,
                                 Directions<float>, MaskingModel, std::span<float>);
template LTMD_API void G1<double>(const AnyDistribution<double>&, Directions<double>,
                                  Directions<double>, MaskingModel, std::span<double>);
template LTMD_API void G2<float>(const AnyDistribution<float>&, Directions<float>,
                                 Directions<float>, Directions<float>, MaskingModel,
                                 std::span<float>);
template LTMD_API void G2<double>(const AnyDistribution<double>&, Directions<double>,
                                  Directions<double>, Directions<double>, MaskingModel,
                                  std::span<double>);

}  // namespace ltmd::inline v0
