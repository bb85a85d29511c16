// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <utility>

#include "ltmd/elementary.h"

/// Visible slopes by inversion of their distribution function, for distributions whose slopes
/// along one direction have a density f with known integrals.
namespace ltmd::inline v0 {

/// Integrals of twice the density f(z) = f(-z) of slopes along one direction, for z >= 0.
template <std::floating_point Real>
struct SlopeIntegrals {
    Real tail;     ///< 2 f from z to infinity; 1 at z = 0.
    Real moment;   ///< 2 x f(x) from z to infinity.
    Real density;  ///< 2 f(z).
    Real bend;     ///< f'(z) / f(z).
};

/// A family of slope densities along one direction: at(z) gives its integrals,
/// rough_tail_inverse(r) the z where the tail is about r, rough_inverse(s, r, z) that where
/// s tail + (1 - s) moment(z) / moment(0) is, given z = rough_tail_inverse(r), hidden(p, q) the
/// integral of 2 (q x - p) f(x) from p / q to infinity.
template <class T>
concept SlopeMarginal = requires(const T& f, typename T::Real x) {
    { f.at(x) } -> std::same_as<SlopeIntegrals<typename T::Real>>;
    { f.rough_tail_inverse(x) } -> std::same_as<typename T::Real>;
    { f.rough_inverse(x, x, x) } -> std::same_as<typename T::Real>;
    { f.hidden(x, x) } -> std::same_as<typename T::Real>;
};

namespace detail {

/// Random numbers closer than this to 0 or 1 count as this: half of a float's step below 1.
template <std::floating_point Real>
inline constexpr Real smallest_uniform = std::numeric_limits<Real>::epsilon() / 4;

template <std::floating_point Real>
Real open_uniform(Real u) {
    return elementary::min(elementary::max(u, smallest_uniform<Real>),
                           1 - 2 * smallest_uniform<Real>);
}

/// z in [0, most) at which W(z) = p tail + q moment + rest is `target`, from a start, by `steps`
/// of Halley's method for log W; dW/dz = -(p + q z) density. W is positive and falls.
template <int steps, SlopeMarginal Marginal, std::floating_point Real>
Real solve(const Marginal& f, Real p, Real q, Real rest, Real target, Real z, Real most) {
    constexpr Real least = static_cast<Real>(1e-30);
    const Real flat = elementary::max(p * std::numeric_limits<Real>::epsilon(), least);
    const auto step = [&] {
        const SlopeIntegrals<Real> at = f.at(z);
        const Real value = elementary::max(p * at.tail + q * at.moment + rest, least);
        const Real facing = elementary::max(p + q * z, flat);
        const Real slope = -facing * elementary::max(at.density, least);
        const Real newton =
            elementary::log(value / elementary::max(target, least)) * (value / slope);
        const Real bend = q / facing + at.bend - slope / value;
        const Real halley =
            newton / elementary::max(Real{0.5}, elementary::min(Real{2}, 1 - newton * bend / 2));
        z = elementary::max(Real{0},
                            elementary::min(z - halley, elementary::max(z, (z + most) / 2)));
    };
    // Not a loop: loops of loops do not vectorise.
    [&]<int... i>(std::integer_sequence<int, i...>) {
        ((static_cast<void>(i), step()), ...);
    }(std::make_integer_sequence<int, steps>{});
    return z;
}

}  // namespace detail

/// The slope x below which the share u of the visible slopes lies, whose density is
/// (p - q x) f(x) for x < p / q; p, q >= 0 are of the order of 1.
template <int steps, SlopeMarginal Marginal, std::floating_point Real>
Real visible_slope(const Marginal& f, Real p, Real q, Real u) {
    constexpr Real tiny = std::numeric_limits<Real>::min();
    u = detail::open_uniform(u);
    const Real moment = f.at(Real{0}).moment;
    const Real hidden = f.hidden(p, q);
    const Real below_zero = p + q * moment;
    const Real above_zero = elementary::max(p - q * moment + hidden, tiny);
    const Real all = 2 * p + hidden;
    const bool low = u * all < below_zero;
    const Real r =
        low ? u * all / below_zero : elementary::min(Real{1}, (1 - u) * all / above_zero);
    const Real tail = f.rough_tail_inverse(r);
    const Real start_low = f.rough_inverse(p / below_zero, r, tail);
    // A triangle or f, whichever is narrower.
    const Real most = p / elementary::max(q, tiny);
    const Real triangle = elementary::min(most, Real{1e18F}) * (1 - std::sqrt(r));
    const Real ratio =
        elementary::min(triangle, tail) / elementary::max(elementary::max(triangle, tail), tiny);
    const Real ratio2 = ratio * ratio;
    const Real start_high =
        elementary::min(triangle, tail) / std::sqrt(std::sqrt(1 + ratio2 * ratio2));
    const Real target = r * (low ? below_zero : above_zero);
    const Real z = detail::solve<steps>(f, p, low ? q : -q, low ? Real{0} : hidden, target,
                                        low ? start_low : start_high,
                                        low ? std::numeric_limits<Real>::max() : most);
    return low ? -z : z;
}

/// The slope x below which the share u of f lies.
template <int steps, SlopeMarginal Marginal, std::floating_point Real>
Real slope_quantile(const Marginal& f, Real u) {
    u = detail::open_uniform(u);
    const Real r = 2 * elementary::min(u, 1 - u);
    const Real z = detail::solve<steps>(f, Real{1}, Real{0}, Real{0}, r, f.rough_tail_inverse(r),
                                        std::numeric_limits<Real>::max());
    return u < Real{0.5} ? -z : z;
}

}  // namespace ltmd::inline v0
