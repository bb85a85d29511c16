// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace ltmd::inline v0 {

/// The root in [low, high] of a function that grows there, by Newton's method from t, kept in the
/// bracket. function(t) returns its value and derivative.
template <class Function>
double find_root(double low, double high, double t, const Function& function) {
    for (int i = 0; i < 60; ++i) {
        const auto [value, slope] = function(t);
        (value > 0 ? high : low) = t;
        double next = t - value / slope;
        if (!(next >= low && next <= high)) next = (low + high) / 2;
        // The next step would be the square of this one.
        if (std::abs(next - t) <= 1e-7 * std::abs(next)) return next;
        t = next;
    }
    return t;
}

}  // namespace ltmd::inline v0
