// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/error_function.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// The Beckmann distribution: slopes are Gaussian, with slope scales alpha_x along U and alpha_y
/// along V, sqrt(2) times their standard deviations (masking-shadowing, eq. 67-69, 81-83).
template <std::floating_point R>
class Beckmann : public SlopeDistribution<Beckmann<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless both are in [1e-6, 1e6].
    Beckmann(double alpha_x, double alpha_y)
        : alpha_x_(
              static_cast<Real>(require_range("alpha_x", alpha_x, smallest_alpha, largest_alpha))),
          alpha_y_(
              static_cast<Real>(require_range("alpha_y", alpha_y, smallest_alpha, largest_alpha))) {
    }
    explicit Beckmann(double alpha) : Beckmann(alpha, alpha) {}

    Real alpha_x() const { return alpha_x_; }
    Real alpha_y() const { return alpha_y_; }

    Real P22(const Slope<Real>& slope) const {
        const Real x = slope.x / alpha_x_, y = slope.y / alpha_y_;
        return std::numbers::inv_pi_v<Real> / (alpha_x_ * alpha_y_) * std::exp(-(x * x + y * y));
    }

    /// Exact, as accurate relative to itself where it is exponentially small:
    /// (e^(-a^2) / (a sqrt(pi)) - erfc(a)) / 2 with a the cotangent of v's angle in units of alpha,
    /// written as an integral of erfc (masking-shadowing, eq. 69, 83).
    Real Lambda(const Direction<Real>& v) const { return hidden_area(v) / v.z; }

    Real projected_area(const Direction<Real>& v) const { return v.z + hidden_area(v); }

    Direction<Real> sample(const Uniform<Real>& u) const {
        const Real phi = 2 * std::numbers::pi_v<Real> * u.y;
        const Real radius = std::sqrt(-std::log(std::max(1 - u.x, smallest_uniform)));
        return normalized(Direction<Real>{alpha_x_ * radius * std::cos(phi),
                                          alpha_y_ * radius * std::sin(phi), 1});
    }

    /// Inverts the distribution function of the visible slopes, for alpha = 1 after the stretch
    /// of both: along the view's azimuth their density is (w_z - |w_xy| x) e^(-x^2) where that is
    /// positive, across it a Gaussian.
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        const Direction<Real> w{alpha_x_ * v.x, alpha_y_ * v.y, v.z};
        const Real across = std::sqrt(w.x * w.x + w.y * w.y);
        const Real scale = 1 / std::sqrt(across * across + w.z * w.z);
        const Real cosine = across > 0 ? w.x / across : Real{1};
        const Real sine = across > 0 ? w.y / across : Real{0};
        const Real x = visible_slope(w.z * scale, across * scale, u.x);
        const Real y = gaussian_slope(u.y);
        return normalized(Direction<Real>{-alpha_x_ * (cosine * x - sine * y),
                                          -alpha_y_ * (sine * x + cosine * y), 1});
    }

private:
    static constexpr Real smallest_uniform = std::numeric_limits<Real>::epsilon() / 4;
    static constexpr Real inv_sqrt_pi = std::numbers::inv_sqrtpi_v<Real>;
    static constexpr bool is_float = std::same_as<Real, float>;

    /// v_z Lambda(v).
    Real hidden_area(const Direction<Real>& v) const {
        const Real x = alpha_x_ * v.x, y = alpha_y_ * v.y;
        const Real across = std::sqrt(x * x + y * y);
        const Real a = v.z / across;
        return across * std::exp(-a * a) * scaled_erfc_integral(v.z, across) * (inv_sqrt_pi / 2);
    }

    /// z >= 0 with erfc(z) = r, within 0.2 %.
    static Real rough_erfc_inverse(Real r) {
        // log(1 - erf^2) is nearly a ratio of polynomials in z^2, solved for z^2.
        constexpr Real b = static_cast<Real>(0.147);
        const Real l = std::log(r * (2 - r));
        const Real half = 2 * std::numbers::inv_pi_v<Real> / b + l / 2, c = -l / b;
        return std::sqrt(std::max(Real{0}, c / (std::sqrt(half * half + c) + half)));
    }

    /// z in [0, most) at which W(z) = e^(-z^2) (p scaled_erfc(z) + q / sqrt(pi)) - rest is
    /// `target`, from a start, by `steps` of Halley's method for log W; dW/dz =
    /// -2 / sqrt(pi) (p + q z) e^(-z^2).
    static Real solve(Real p, Real q, Real rest, Real target, Real z, Real most, int steps) {
        constexpr Real least = static_cast<Real>(1e-30);
        const Real flat = p * std::numeric_limits<Real>::epsilon();
        for (int i = 0; i < steps; ++i) {
            const Real gauss = std::exp(-z * z);
            const Real value =
                std::max(gauss * (p * scaled_erfc(z, Real{1}) + q * inv_sqrt_pi) - rest, least);
            const Real facing = std::max(p + q * z, flat);
            const Real slope = -2 * inv_sqrt_pi * facing * std::max(gauss, least);
            const Real newton = std::log(value / std::max(target, least)) * value / slope;
            const Real bend = q / facing - 2 * z - slope / value;
            const Real step = newton / std::clamp(1 - newton * bend / 2, Real{0.5}, Real{2});
            z = std::max(Real{0}, std::min(z - step, std::max(z, (z + most) / 2)));
        }
        return z;
    }

    /// The slope x at which the share u of the visible slopes (p - q x) e^(-x^2), x < p / q, lies
    /// below; p^2 + q^2 = 1.
    static Real visible_slope(Real p, Real q, Real u) {
        u = std::clamp(u, smallest_uniform, 1 - 2 * smallest_uniform);
        // Beyond slope 12 lies nothing that can be told from 0.
        const Real most = std::min(p / std::max(q, std::numeric_limits<Real>::min()), Real{12});
        const Real rest = -q * inv_sqrt_pi * std::exp(-most * most) * scaled_erfc_integral(p, q);
        const Real all = 2 * p - rest;
        const Real below_zero = p + q * inv_sqrt_pi;
        const Real above_zero =
            std::max(p - q * inv_sqrt_pi - rest, std::numeric_limits<Real>::min());
        const bool low = u * all < below_zero;
        const Real r = low ? u * all / below_zero : std::min(Real{1}, (1 - u) * all / above_zero);
        const Real gaussian = rough_erfc_inverse(r);
        // The two parts of the density on the side of x < 0, weighted.
        const Real share = p / below_zero;
        const Real start_low = share * gaussian + (1 - share) * std::sqrt(-std::log(r));
        // A triangle for small p / q and a Gaussian for large.
        const Real triangle = most * (1 - std::sqrt(r));
        const Real t2 = triangle * triangle, g2 = gaussian * gaussian;
        const Real start_high =
            triangle * gaussian /
            std::sqrt(std::sqrt(std::max(t2 * t2 + g2 * g2, std::numeric_limits<Real>::min())));
        const Real z = solve(p, low ? q : -q, low ? Real{0} : rest,
                             low ? r * below_zero : r * above_zero, low ? start_low : start_high,
                             low ? std::numeric_limits<Real>::max() : most, is_float ? 2 : 4);
        return low ? -z : z;
    }

    static Real gaussian_slope(Real u) {
        u = std::clamp(u, smallest_uniform, 1 - 2 * smallest_uniform);
        const Real r = 2 * std::min(u, 1 - u);
        const Real z = solve(1, 0, 0, r, rough_erfc_inverse(r), std::numeric_limits<Real>::max(),
                             is_float ? 1 : 2);
        return u < Real{0.5} ? -z : z;
    }

    Real alpha_x_, alpha_y_;
};

/// A rational fit of the Beckmann distribution's Lambda for a = 1 / (alpha tan(theta)), 0 from 1.6
/// on: G1 is up to 0.35 % off (masking-shadowing, eq. 69).
template <std::floating_point Real>
Real beckmann_lambda_rational(Real a) {
    const Real numerator = 1 - static_cast<Real>(1.259) * a + static_cast<Real>(0.396) * a * a;
    return a < static_cast<Real>(1.6)
               ? numerator / (static_cast<Real>(3.535) * a + static_cast<Real>(2.181) * a * a)
               : Real{0};
}

}  // namespace ltmd::inline v0
