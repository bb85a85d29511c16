// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <type_traits>

#include "ltmd/elementary.h"

/// The complementary error function and its integral without their factor e^(-z^2), which makes
/// them neither vanish nor cancel at large z. Free of branches, so that loops of them vectorise.
namespace ltmd::inline v0 {

/// e^(z^2) erfc(z) of z = p / q, for p, q >= 0 and not both 0: in (0, 1]. Relative error 3e-7 in
/// float, 1e-14 in double: a Chebyshev fit of (1 + z) erfcx(z) in (z - 3) / (z + 3).
template <std::floating_point Real>
Real scaled_erfc(Real p, Real q) {
    const Real t = (p - 3 * q) / (p + 3 * q), scale = q / (p + q);
    if constexpr (std::is_same_v<Real, float>) {
        constexpr std::array c{7.1600455e-01F,  -2.3092707e-01F, 9.902294e-02F,  -1.0241782e-02F,
                               -2.3821559e-02F, 2.1997884e-02F,  -9.701249e-03F, 1.5167397e-03F,
                               5.9014885e-04F,  -2.51037e-04F};
        return elementary::polynomial(c, t) * scale;
    } else {
        constexpr std::array c{
            0.71600460472556,        -0.23092733308381003,    0.09902075367938021,
            -0.010235388898950924,   -0.023803913106181913,   0.021957764011068987,
            -0.009750689332170371,   0.0016185691514113167,   0.000645814514568727,
            -0.00036728867162658514, -2.0552996300592535e-05, 5.612022340436782e-05,
            -1.5106772321176495e-06, -8.992333530880599e-06,  2.547172662334338e-07,
            1.5925426490212637e-06,  6.604215583375912e-08,   -2.974219208125978e-07,
            -4.850005983037507e-08,  5.353924422623452e-08,   1.4771017618850546e-08,
            -7.97932223996508e-09,   -2.0641250593713774e-09, 6.952631004272627e-10};
        return static_cast<Real>(elementary::polynomial(c, static_cast<double>(t))) * scale;
    }
}

/// sqrt(pi) e^(z^2) times the integral of erfc from z to infinity, which is
/// 1 - sqrt(pi) z e^(z^2) erfc(z), of z = p / q as above: in [0, 1]. Relative error 4e-7 in float,
/// 1e-14 in double: a fit of (1 + z)^2 times it.
template <std::floating_point Real>
Real scaled_erfc_integral(Real p, Real q) {
    const Real t = (p - 3 * q) / (p + 3 * q), scale = q / (p + q);
    if constexpr (std::is_same_v<Real, float>) {
        constexpr std::array c{7.709785e-01F,   -3.8987872e-01F, 9.61867e-02F,   9.662003e-02F,
                               -1.2321787e-01F, 5.8317598e-02F,  7.491669e-05F,  -1.55520225e-02F,
                               6.865135e-03F,   3.9989184e-04F,  -8.874429e-04F, 9.324738e-05F};
        return elementary::polynomial(c, t) * scale * scale;
    } else {
        constexpr std::array c{
            0.7709785730571949,      -0.3898785046549583,     0.09618184448496955,
            0.09661660086470483,     -0.12315930991920647,    0.05832989977772589,
            -0.00018532495382587912, -0.015553717271930946,   0.007398554635911495,
            0.0003456526744278094,   -0.0014201343630400837,  0.00018212433497166248,
            0.00024465413828150335,  -5.0034263482201676e-05, -4.71922171796609e-05,
            8.994731983476496e-06,   1.0167791349167306e-05,  -1.0144428969118472e-06,
            -2.1721689111526782e-06, -4.0990615051976184e-08, 3.758697882642066e-07,
            4.645815662964758e-08,   -3.6355330855824715e-08, -7.218087396196542e-09};
        return static_cast<Real>(elementary::polynomial(c, static_cast<double>(t))) * scale * scale;
    }
}

/// z >= 0 with erfc(z) = r in (0, 1], within 0.2 %.
template <std::floating_point Real>
Real rough_erfc_inverse(Real r) {
    // log(1 - erf^2) is nearly a ratio of polynomials in z^2 (with b = 0.147), solved for z^2.
    constexpr Real b = static_cast<Real>(0.147);
    const Real l = elementary::log(r * (2 - r));
    const Real half = 2 * std::numbers::inv_pi_v<Real> / b + l / 2, c = -l / b;
    return std::sqrt(elementary::max(Real{0}, c / (std::sqrt(half * half + c) + half)));
}

}  // namespace ltmd::inline v0
