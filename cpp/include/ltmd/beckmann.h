// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/error_function.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"
#include "ltmd/visible_slope.h"

namespace ltmd::inline v0 {

/// The Beckmann distribution: slopes are Gaussian, with slope scales alpha_x along U and alpha_y
/// along V, sqrt(2) times their standard deviations (masking-shadowing, eq. 67-69, 81-83).
template <std::floating_point R>
class Beckmann : public SlopeDistribution<Beckmann<R>, R> {
public:
    using Real = R;
    /// Free of branches: arrays are evaluated in vectors.
    static constexpr bool vectorizes = true;

    /// Throws InvalidInput unless both are in [1e-6, 1e6].
    Beckmann(double alpha_x, double alpha_y)
        : alpha_x_(
              static_cast<Real>(require_range("alpha_x", alpha_x, smallest_alpha, largest_alpha))),
          alpha_y_(
              static_cast<Real>(require_range("alpha_y", alpha_y, smallest_alpha, largest_alpha))),
          inverse_x_(static_cast<Real>(1 / alpha_x)),
          inverse_y_(static_cast<Real>(1 / alpha_y)),
          peak_(std::numbers::inv_pi_v<Real> / (alpha_x_ * alpha_y_)) {}
    explicit Beckmann(double alpha) : Beckmann(alpha, alpha) {}

    Real alpha_x() const { return alpha_x_; }
    Real alpha_y() const { return alpha_y_; }

    Real P22(const Slope<Real>& slope) const {
        const Real x = slope.x * inverse_x_, y = slope.y * inverse_y_;
        return peak_ * elementary::exp(-(x * x + y * y));
    }

    Real D(const Direction<Real>& m) const {
        const Real x = m.x * inverse_x_, y = m.y * inverse_y_;
        // Nearer to the horizon, exp() is 0.
        constexpr auto least = static_cast<Real>(is_float ? 1e-18 : 1e-153);
        const Real inverse = 1 / elementary::max(m.z * m.z, least);
        const Real value = peak_ * elementary::exp(-(x * x + y * y) * inverse) * inverse * inverse;
        return m.z > 0 ? value : Real{0};
    }

    Real D_any_length(const Direction<Real>& m) const { return D(m); }

    /// Exact, as accurate relative to itself where it is exponentially small:
    /// (e^(-a^2) / (a sqrt(pi)) - erfc(a)) / 2 with a the cotangent of v's angle in units of alpha,
    /// written as an integral of erfc (masking-shadowing, eq. 69, 83).
    Real Lambda(const Direction<Real>& v) const { return hidden_area(v) / v.z; }

    Real G1(const Direction<Real>& v) const {
        const Real value = v.z / projected_area(v);
        return v.z > 0 ? value : Real{0};
    }

    Real projected_area(const Direction<Real>& v) const { return v.z + hidden_area(v); }

    Direction<Real> sample_any_length(const Uniform<Real>& u) const {
        const auto [cosine, sine] = elementary::turn(u.y);
        const Real radius = std::sqrt(-elementary::log(1 - detail::open_uniform(u.x)));
        return {alpha_x_ * radius * cosine, alpha_y_ * radius * sine, 1};
    }

    /// Inverts the distribution function of the visible slopes, of alpha = 1 after a stretch: along
    /// the view's azimuth their density is (w_z - |w_xy| x) e^(-x^2) where that is positive, across
    /// it a Gaussian.
    Direction<Real> sample_visible_any_length(const Direction<Real>& v,
                                              const Uniform<Real>& u) const {
        const Direction<Real> w{alpha_x_ * v.x, alpha_y_ * v.y, v.z};
        const Real across = std::sqrt(w.x * w.x + w.y * w.y);
        const Real scale = 1 / std::sqrt(across * across + w.z * w.z);
        const Real flat = 1 / elementary::max(across, std::numeric_limits<Real>::min());
        const Real cosine = across > 0 ? w.x * flat : Real{1}, sine = w.y * flat;
        const Gaussian slopes;
        const Real x = visible_slope<is_float ? 2 : 4>(slopes, w.z * scale, across * scale, u.x);
        const Real y = slope_quantile<is_float ? 1 : 2>(slopes, u.y);
        return {-alpha_x_ * (cosine * x - sine * y), -alpha_y_ * (sine * x + cosine * y), 1};
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        return normalized(sample_any_length(u));
    }
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return normalized(sample_visible_any_length(v, u));
    }

private:
    static constexpr Real inv_sqrt_pi = std::numbers::inv_sqrtpi_v<Real>;
    static constexpr bool is_float = std::same_as<Real, float>;

    /// Slopes along one direction for alpha = 1.
    struct Gaussian {
        using Real = R;
        SlopeIntegrals<Real> at(Real z) const {
            const Real bell = elementary::exp(-z * z);
            return {bell * scaled_erfc(z, Real{1}), bell * inv_sqrt_pi, 2 * inv_sqrt_pi * bell,
                    -2 * z};
        }
        Real rough_tail_inverse(Real r) const { return rough_erfc_inverse(r); }
        Real rough_inverse(Real share, Real r, Real tail) const {
            return share * tail + (1 - share) * std::sqrt(-elementary::log(r));
        }
        Real hidden(Real p, Real q) const {
            const Real a = p / q;
            return q * inv_sqrt_pi * elementary::exp(-a * a) * scaled_erfc_integral(p, q);
        }
    };

    /// v_z Lambda(v).
    Real hidden_area(const Direction<Real>& v) const {
        const Real x = alpha_x_ * v.x, y = alpha_y_ * v.y;
        return Gaussian{}.hidden(v.z, std::sqrt(x * x + y * y)) / 2;
    }

    Real alpha_x_, alpha_y_, inverse_x_, inverse_y_, peak_;
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

extern template LTMD_API AnyDistribution<float>::AnyDistribution(Beckmann<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(Beckmann<double>);

}  // namespace ltmd::inline v0
