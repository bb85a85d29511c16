// SPDX-License-Identifier: Apache-2.0
#include "ltmd/smith_masking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ltmd/errors.h"
#include "ltmd/require_range.h"

namespace ltmd::inline v0 {
namespace {

/// The integral of f over [0, infinity) by double exponentials, x = exp(pi/2 sinh t), which takes
/// singular ends and algebraic tails. The step is halved until two results agree.
double integral_to_infinity(const std::function<double(double)>& f) {
    const auto term = [&](double t) {
        const double x = std::exp(std::numbers::pi / 2 * std::sinh(t));
        return f(x) * x * std::numbers::pi / 2 * std::cosh(t);
    };
    constexpr double start = -5.5, last = 5.5;
    double step = 1. / 8, total = 0, peak = 0, end = start;
    // Up to where nothing is added any more: a power of a still greater x might overflow.
    for (int small = 0; end < last && small < 4; end += step) {
        const double value = term(end);
        total += value;
        peak = std::max(peak, std::abs(value));
        small = end > 0 && std::abs(value) < 1e-18 * peak ? small + 1 : 0;
    }
    double before = total * step;
    for (int level = 0; level < 6; ++level) {
        for (double t = start + step / 2; t < end; t += step) total += term(t);
        step /= 2;
        const double now = total * step;
        if (!std::isfinite(now)) break;
        if (std::abs(now - before) <= 1e-12 * std::abs(now)) return now;
        before = now;
    }
    throw InvalidInput("the integral over slopes does not converge");
}

}  // namespace

double smith_lambda(const std::function<double(double)>& slopes, double cotangent) {
    require_range("cotangent", cotangent, std::numeric_limits<double>::min(), 1e300);
    return integral_to_infinity([&](double x) { return x * slopes(cotangent + x); }) / cotangent;
}

double smith_lambda_of_shape(const std::function<double(double)>& shape, double a) {
    require_range("a", a, std::numeric_limits<double>::min(), 1e300);
    // In polar coordinates: of the circle of radius r the arc beyond a counts, and the integral of
    // (r cos phi - a) over that arc is 2 a (tan psi - psi), a = r cos psi.
    return 2 * integral_to_infinity([&](double x) {
               const double r = a + x;
               const double tangent = std::sqrt(x * (a + r)) / a;
               // tan psi - psi without its cancellation: psi^3 / 3 + 2 psi^5 / 15 + ...
               const double t2 = tangent * tangent;
               const double area =
                   tangent < 0.02 ? tangent * t2 * (1. / 3 - t2 * (1. / 5 - t2 * (1. / 7 - t2 / 9)))
                                  : tangent - std::atan(tangent);
               return shape(r) * r * area;
           });
}

double shape_integral(const std::function<double(double)>& shape) {
    return 2 * std::numbers::pi * integral_to_infinity([&](double r) { return r * shape(r); });
}

}  // namespace ltmd::inline v0
