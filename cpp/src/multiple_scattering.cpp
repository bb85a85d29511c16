// SPDX-License-Identifier: Apache-2.0
#include "ltmd/multiple_scattering.h"

#include "for_items.h"

namespace ltmd::inline v0 {

template <std::floating_point Real>
void single_scattering_albedo(const AnyDistribution<Real>& d, std::span<const Direction<Real>> wo,
                              MaskingModel model, int points, std::span<Real> out) {
    for_items<16>(out, [&](auto& o) { return single_scattering_albedo(d, o, model, points); }, wo);
}

template LTMD_API void single_scattering_albedo<float>(const AnyDistribution<float>&,
                                                       std::span<const Direction<float>>,
                                                       MaskingModel, int, std::span<float>);
template LTMD_API void single_scattering_albedo<double>(const AnyDistribution<double>&,
                                                        std::span<const Direction<double>>,
                                                        MaskingModel, int, std::span<double>);

}  // namespace ltmd::inline v0
