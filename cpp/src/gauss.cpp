// SPDX-License-Identifier: Apache-2.0
#include "ltmd/gauss.h"

#include "gauss_legendre.h"

namespace ltmd::inline v0 {

double gauss_peak(double m) {
    require_range("m", m, 1e-6, 2);
    // Beyond 7 m the integrand is below rounding.
    constexpr int panels = 16;
    const double width = std::min(std::numbers::pi / 2, 7 * m) / panels;
    double sum = 0;
    for (int i = 0; i < panels; ++i) {
        for (const auto [node, weight] : gauss8) {
            const double theta = width * (i + node), x = theta / m;
            sum += width * weight * std::exp(-x * x) * std::sin(2 * theta);
        }
    }
    return std::numbers::inv_pi / sum;
}

template AnyDistribution<float>::AnyDistribution(Gauss<float>);
template AnyDistribution<double>::AnyDistribution(Gauss<double>);

}  // namespace ltmd::inline v0
