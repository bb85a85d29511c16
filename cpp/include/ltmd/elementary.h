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

/// x to the nearest integer, for |x| < 2^22.
inline float nearest(float x) {
    constexpr float round = 12582912;  // 3 * 2^22
    return (x + round) - round;
}

/// 2^n e^r for an integer n in [-126, 127] and r in [-log(2) / 2, log(2) / 2]; 0 for n = -127,
/// infinite for 128.
inline float scaled_exp(float n, float r) {
    constexpr std::array c{0.49999994F, 0.1666652F, 0.0416684F, 0.00836885F, 0.00138143206F};
    const float power = std::bit_cast<float>((static_cast<std::int32_t>(n) + 127) << 23);
    return (1 + (r + r * r * polynomial(c, r))) * power;
}

/// e^x within 1 for x <= 88; in float 0 below -87.
inline float exp(float x) {
    constexpr float log2_high = 0.693359375F, log2_low = -2.12194440e-4F;
    const float bounded = max(-87.0F, x);
    const float n = nearest(bounded * std::numbers::log2e_v<float>);
    const float result = scaled_exp(n, (bounded - n * log2_high) - n * log2_low);
    return x < -87 ? 0.0F : result;
}
inline double exp(double x) { return std::exp(x); }

/// x = 2^n (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), of a finite x, not below the smallest normal
/// number.
struct BinaryParts {
    float n, f;
};
inline BinaryParts binary_parts(float x) {
    const auto bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t n = (bits - 0x3f3504f3) >> 23;
    return {static_cast<float>(n), std::bit_cast<float>(bits - n * 0x800000) - 1};
}

/// log(1 + f) - f of such an f.
inline float log_curve(float f) {
    constexpr std::array c{0.33333331F, -0.2500082F,  0.20001227F,  -0.16623358F,
                           0.1420176F,  -0.13160175F, 0.127615616F, -0.0763449073F};
    const float f2 = f * f;
    return f * f2 * polynomial(c, f) - f2 / 2;
}

/// log(x) within 2 for a finite x, not below the smallest normal number.
inline float log_of_normal(float x) {
    const auto [n, f] = binary_parts(x);
    constexpr float log2_high = 0.693359375F, log2_low = -2.12194440e-4F;
    return (f + (log_curve(f) + n * log2_low)) + n * log2_high;
}
/// log(x) within 2 for x > 0; for smaller x that of the smallest normal number.
inline float log(float x) { return log_of_normal(max(std::numeric_limits<float>::min(), x)); }
inline double log(double x) { return std::log(x); }

/// log(1 + x) within 3 for x > -1.
inline float log1p(float x) {
    const float bounded = min(x, std::numeric_limits<float>::max());
    const float sum = 1 + bounded;
    return log_of_normal(sum) + (bounded - (sum - 1)) / sum;
}
inline double log1p(double x) { return std::log1p(x); }

/// x^y within 1 + 2 |y| for a positive normal x and |y| <= 1000; in float 0 below the smallest
/// normal number.
inline float pow(float x, float y) {
    const auto [n, f] = binary_parts(x);
    // y log2(x) = whole + r: y has 24 bits and n has 8, the first half of y times n is exact.
    const float y_high = std::bit_cast<float>(std::bit_cast<std::int32_t>(y) & ~0xfff);
    const float log2 = std::numbers::log2e_v<float> * (f + log_curve(f));
    const float a = y_high * n, whole = nearest(a);
    const float b = (a - whole) + ((y - y_high) * n + y * log2), more = nearest(b);
    const float r = (b - more) * std::numbers::ln2_v<float>;
    return scaled_exp(max(-127.0F, min(whole + more, 128.0F)), r);
}
inline double pow(double x, double y) { return std::pow(x, y); }

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
    const float quarters = 4 * u;
    const float n = nearest(quarters);
    const float r = quarters - n, r2 = r * r;
    constexpr std::array s{1.5707964F, -0.645963430F, 0.07968003F, -0.0046016256F};
    constexpr std::array c{-1.2337005F, 0.25366923F, -0.020860162F, 0.00090376026F};
    const float sine = r * polynomial(s, r2), cosine = 1 + r2 * polynomial(c, r2);
    // Swapped in odd quarters; the signs are the first bits. Choices would become branches.
    const auto quarter = static_cast<std::uint32_t>(static_cast<std::int32_t>(n));
    const auto a = std::bit_cast<std::uint32_t>(cosine), b = std::bit_cast<std::uint32_t>(sine);
    const std::uint32_t swap = (a ^ b) & (0 - (quarter & 1));
    return {std::bit_cast<float>(a ^ swap ^ ((quarter + 1) >> 1 << 31)),
            std::bit_cast<float>(b ^ swap ^ (quarter >> 1 << 31))};
}
inline CosSin<double> turn(double u) {
    const double phi = 2 * std::numbers::pi * u;
    return {std::cos(phi), std::sin(phi)};
}

}  // namespace ltmd::inline v0::elementary
