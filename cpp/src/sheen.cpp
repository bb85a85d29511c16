// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sheen.h"

namespace ltmd::inline v0 {

double sheen_lambda_fit(double alpha, double cosine) {
    require_range("alpha", alpha, 1e-3, 1);
    // The paper's rows for alpha = 0 and 1, interpolated by (1 - alpha)^2.
    const double weight = (1 - alpha) * (1 - alpha);
    const auto mix = [&](double at_0, double at_1) { return std::lerp(at_1, at_0, weight); };
    const double a = mix(25.3245, 21.5473), b = mix(3.32435, 3.82987), c = mix(0.16801, 0.19823),
                 d = mix(-1.27393, -1.97760), e = mix(-4.85967, -4.32054);
    const auto L = [&](double x) { return a / (1 + b * std::pow(x, c)) + d * x + e; };
    return std::exp(cosine < 0.5 ? L(cosine) : 2 * L(0.5) - L(1 - cosine));
}

template AnyDistribution<float>::AnyDistribution(Sheen<float>);
template AnyDistribution<double>::AnyDistribution(Sheen<double>);

}  // namespace ltmd::inline v0
