// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// The mean of function(m) over the normals that v sees by Smith's masking, from a grid of
/// `points` x `points`.
template <MicrofacetDistribution D, class Function, std::floating_point Real = typename D::Real>
Real visible_normals_mean(const D& d, const Direction<Real>& v, int points,
                          const Function& function) {
    double sum = 0;
    for (int i = 0; i < points; ++i)
        for (int j = 0; j < points; ++j) {
            const auto at = [&](int k) { return static_cast<Real>((k + 0.5) / points); };
            sum += function(d.sample_visible(v, {at(i), at(j)}));
        }
    return static_cast<Real>(sum / (static_cast<double>(points) * points));
}

}  // namespace ltmd::inline v0
