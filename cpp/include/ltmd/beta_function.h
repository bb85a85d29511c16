// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace ltmd::inline v0 {

/// Euler's beta function, the integral of x^(p-1) (1-x)^(q-1) over [0, 1], for p and q in
/// [1, 1e30].
inline double beta_function(double p, double q) {
    // Recurrences lead to arguments where Stirling's series is exact to rounding. All in
    // logarithms: for large arguments the factors leave the range of double.
    double logarithm = 0;
    for (; p < 12; p += 1) logarithm += std::log1p(q / p);
    for (; q < 12; q += 1) logarithm += std::log1p(p / q);
    const auto series = [](double x) {
        const double y2 = 1 / (x * x);
        return (1. / 12 - y2 * (1. / 360 - y2 * (1. / 1260 - y2 * (1. / 1680 - y2 / 1188)))) / x;
    };
    logarithm += series(p) + series(q) - series(p + q) - (p - 0.5) * std::log1p(q / p) -
                 q * std::log1p(p / q);
    return std::sqrt(2 * std::numbers::pi / q) * std::exp(logarithm);
}

}  // namespace ltmd::inline v0
