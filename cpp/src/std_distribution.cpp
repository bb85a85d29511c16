// SPDX-License-Identifier: Apache-2.0
#include "ltmd/std_distribution.h"

namespace ltmd::inline v0 {
namespace {

/// Gamma(k + 1/2) / Gamma(k).
double half_step_of_gamma(double k) {
    if (k < 100) return std::tgamma(k + 0.5) / std::tgamma(k);
    // DLMF 5.11.13 at k - 1/4, where the odd terms vanish.
    const double x = 1 / ((k - 0.25) * (k - 0.25));
    return std::sqrt(k - 0.25) * (1 + x * (1.0 / 64 + x * (-19.0 / 8192 + x * 631.0 / 524288)));
}

/// 2 times the integral from z to infinity of f, over (1 + z^2 / k)^-k, at y = z / sqrt(k + z^2);
/// beta = 1 / B(k, 1/2).
double scaled_tail(double k, double beta, double y) {
    const double q = 1 - y * y;
    if (y * y * (k + 2) < 1.5) {
        // 1 - I_(y^2)(1/2, k) by its series (DLMF 8.17.8).
        double term = 2 * beta * y, sum = term;
        for (int n = 0; n < 200 && term > 1e-17 * sum; ++n) {
            term *= (k + 0.5 + n) / (1.5 + n) * y * y;
            sum += term;
        }
        return std::exp(-k * std::log1p(-y * y)) - sum;
    }
    // I_q(k, 1/2) by its continued fraction (DLMF 8.17.22), from its end.
    double fraction = 1;
    for (int n = 400; n > 0; --n) {
        const double m = n / 2, even = m * (0.5 - m) / ((k + 2 * m - 1) * (k + 2 * m)),
                     odd = -(k + m) * (k + 0.5 + m) / ((k + 2 * m) * (k + 2 * m + 1));
        fraction = 1 + (n % 2 == 0 ? even : odd) * q / fraction;
    }
    return beta * y / k / fraction;
}

/// The polynomial of t through `values` at the nodes cos(pi (i + 1/2) / size) of Chebyshev.
template <class Real, std::size_t count>
std::array<Real, count> interpolate(const std::array<double, count>& values) {
    std::array<double, count> power{}, before{}, now{};
    now[0] = 1;
    for (std::size_t degree = 0; degree < count; ++degree) {
        double coefficient = 0;
        for (std::size_t i = 0; i < count; ++i)
            coefficient += values[i] * std::cos(std::numbers::pi * static_cast<double>(degree) *
                                                (static_cast<double>(i) + 0.5) / count);
        coefficient *= (degree == 0 ? 1.0 : 2.0) / count;
        for (std::size_t i = 0; i <= degree; ++i) power[i] += coefficient * now[i];
        // T_(n+1) = 2 t T_n - T_(n-1), and T_1 = t.
        std::array<double, count> next{};
        for (std::size_t i = 0; i + 1 < count; ++i) next[i + 1] = (degree == 0 ? 1 : 2) * now[i];
        for (std::size_t i = 0; i < count && degree > 0; ++i) next[i] -= before[i];
        before = now;
        now = next;
    }
    std::array<Real, count> result;
    for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<Real>(power[i]);
    return result;
}

}  // namespace

template <std::floating_point R>
StudentSlopes<R>::StudentSlopes(double k)
    : k_(static_cast<Real>(k)), inv_k_(static_cast<Real>(1 / k)), heavy_(k > 1.5 ? 0 : 1) {
    const double root_k = std::sqrt(k);
    const double beta = half_step_of_gamma(k) / std::sqrt(std::numbers::pi);
    c_ = static_cast<Real>(beta / root_k);
    const double moment = 2 * beta * root_k / (2 * k - 1);
    moment_ = static_cast<Real>(moment);
    // z / sqrt(1 + z^2 / k) = m b / (a - m) for m = (1 + t) / 2 from 0 to 1.
    const double b = std::min(root_k, 3.0), a = 1 + b / root_k;
    a_ = static_cast<Real>(2 * a - 1);
    b_ = static_cast<Real>(b);
    std::array<double, count> tails, hidden;
    for (std::size_t i = 0; i < count; ++i) {
        const double t = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / count);
        const double z = (1 + t) / 2 * b / (a - (1 + t) / 2), y = z / root_k;
        const double tail = scaled_tail(k, beta, y);
        tails[i] = tail * (1 + z);
        hidden[i] = (1 - z * tail / moment) * (1 + z) * (1 + z);
    }
    tail_ = interpolate<Real>(tails);
    hidden_ = interpolate<Real>(hidden);
}

template class StudentSlopes<float>;
template class StudentSlopes<double>;

double std_lambda_rational(double a, double gamma) {
    const double g = gamma;
    const double f21 =
        a * (1.066 + a * (2.655 + a * 4.892)) / (1.038 + a * (2.969 + a * (4.305 + a * 4.418)));
    const double f22 = (14.402 + g * (-27.145 + g * (20.574 - g * 2.745))) /
                       (-30.612 + g * (86.567 + g * (-84.341 + g * 29.938)));
    const double f23 = (-129.404 + g * (324.987 + g * (-299.305 + g * 93.268))) /
                       (-92.609 + g * (256.006 + g * (-245.663 + g * 86.064)));
    const double f24 = (6.537 + a * (6.074 + a * (-0.623 + a * 5.223))) /
                       (6.538 + a * (6.103 + a * (-3.218 + a * 6.347)));
    const double s1 = std::exp(g * std::log(g - 1) + (1.5 - g) * std::log(g - 1 + a * a)) / a;
    const double s2 = f21 * (f22 + f23 * f24);
    const double scale = 1 / (half_step_of_gamma(g - 0.5) * std::sqrt(std::numbers::pi));
    return scale * (s1 / (2 * g - 3) + std::sqrt(g - 1) * s2) - 0.5;
}

template AnyDistribution<float>::AnyDistribution(STD<float>);
template AnyDistribution<double>::AnyDistribution(STD<double>);

}  // namespace ltmd::inline v0
