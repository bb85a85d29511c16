// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

/// Elementary functions for float that have no branches and call nothing, so that loops of them
/// vectorise; for double those of the standard library. Errors are relative, in units of the
/// type's epsilon.
namespace ltmd::inline v0::elementary {

/// The smaller and the greater of two values, by value: references, as the standard library takes,
/// may keep loops from being vectorised.
template <std::floating_point Real>
Real min(Real a, Real b) {
    return b < a ? b : a;
}
template <std::floating_point Real>
Real max(Real a, Real b) {
    return a < b ? b : a;
}

/// The polynomial with coefficients c, lowest power first, at t.
template <std::floating_point Real, std::size_t count>
Real polynomial(const std::array<Real, count>& c, Real t) {
    // Not a loop: loops of loops do not vectorise.
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
        Real sum = c[count - 1];
        ((sum = sum * t + c[count - 2 - i]), ...);
        return sum;
    }(std::make_index_sequence<count - 1>{});
}

/// e^x within 1 for x <= 88; in float 0 below -87.
inline float exp(float x) {
    // e^x = 2^n e^r with r in [-log(2) / 2, log(2) / 2]; adding 3 * 2^22 rounds to integers.
    constexpr float round = 12582912, log2_high = 0.693359375F, log2_low = -2.12194440e-4F;
    const float bounded = max(-87.0F, x);
    const float n = (bounded * std::numbers::log2e_v<float> + round) - round;
    const float r = (bounded - n * log2_high) - n * log2_low;
    constexpr std::array c{0.49999994F, 0.1666652F, 0.0416684F, 0.00836885F, 0.00138143206F};
    const float power = std::bit_cast<float>((static_cast<std::int32_t>(n) + 127) << 23);
    const float result = (1 + (r + r * r * polynomial(c, r))) * power;
    return x < -87 ? 0.0F : result;
}
inline double exp(double x) { return std::exp(x); }

/// log(x) within 2 for a finite x, not below the smallest normal number.
inline float log_of_normal(float x) {
    // x = 2^n (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)).
    const auto bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t n = (bits - 0x3f3504f3) >> 23;
    const float f = std::bit_cast<float>(bits - n * 0x800000) - 1;
    constexpr std::array c{0.33333331F, -0.2500082F,  0.20001227F,  -0.16623358F,
                           0.1420176F,  -0.13160175F, 0.127615616F, -0.0763449073F};
    constexpr float log2_high = 0.693359375F, log2_low = -2.12194440e-4F;
    const auto power = static_cast<float>(n);
    const float f2 = f * f;
    return (f + (f * f2 * polynomial(c, f) + power * log2_low - f2 / 2)) + power * log2_high;
}
/// log(x) within 2 for x > 0; for smaller x that of the smallest normal number.
inline float log(float x) { return log_of_normal(max(std::numeric_limits<float>::min(), x)); }
inline double log(double x) { return std::log(x); }

/// log(1 + x) within 3 for x >= 0.
inline float log1p(float x) {
    const float bounded = min(x, std::numeric_limits<float>::max());
    const float sum = 1 + bounded;
    return log_of_normal(sum) + (bounded - (sum - 1)) / sum;
}
inline double log1p(double x) { return std::log1p(x); }

/// e^x - 1 within 3 for x >= 0.
inline float expm1(float x) {
    constexpr std::array c{1.0F,          0.50000006F,   0.16666663F,   0.04166532F,
                           0.0083336346F, 0.0013997324F, 0.00019841192F};
    return x < 0.5F ? x * polynomial(c, x) : exp(x) - 1;
}
inline double expm1(double x) { return std::expm1(x); }

/// cos(2 pi u) and sin(2 pi u) for u in [0, 1], within 1 of 1.
template <std::floating_point Real>
struct CosSin {
    Real cos, sin;
};
inline CosSin<float> turn(float u) {
    // Quarters are exact in float; the rest is in [-1/2, 1/2] quarters.
    constexpr float round = 12582912;
    const float quarters = 4 * u;
    const float n = (quarters + round) - round;
    const float r = quarters - n, r2 = r * r;
    constexpr std::array s{1.5707964F, -0.645963430F, 0.07968003F, -0.0046016256F};
    constexpr std::array c{-1.2337005F, 0.25366923F, -0.020860162F, 0.00090376026F};
    const float sine = r * polynomial(s, r2), cosine = 1 + r2 * polynomial(c, r2);
    const auto quarter = static_cast<std::int32_t>(n);
    const bool odd = (quarter & 1) != 0;
    const float x = odd ? sine : cosine, y = odd ? cosine : sine;
    return {((quarter + 1) & 2) != 0 ? -x : x, (quarter & 2) != 0 ? -y : y};
}
inline CosSin<double> turn(double u) {
    const double phi = 2 * std::numbers::pi * u;
    return {std::cos(phi), std::sin(phi)};
}

}  // namespace ltmd::inline v0::elementary
