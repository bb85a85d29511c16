// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/export.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"
#include "ltmd/visible_slope.h"

namespace ltmd::inline v0 {

/// Student's distribution of slopes along one direction, f(z) = c (1 + z^2 / k)^(-k - 1/2), with
/// its integrals; the Gaussian e^(-z^2) / sqrt(pi) for k to infinity.
template <std::floating_point R>
class StudentSlopes {
public:
    using Real = R;

    /// For k in (1/2, 1e9]. Fits the integrals; takes about 20 microseconds.
    LTMD_API explicit StudentSlopes(double k);

    SlopeIntegrals<Real> at(Real z) const {
        const Real s = 1 + z * z * inv_k_, root = std::sqrt(s);
        const Real power = elementary::exp(-k_ * elementary::log1p(z * z * inv_k_));
        return {power * tail_factor(z, root), moment_ * power * root, 2 * c_ * power / root,
                -(2 + inv_k_) * z / s};
    }
    Real rough_tail_inverse(Real r) const { return flat_to_slope(-elementary::log(r)); }
    Real rough_inverse(Real share, Real r, Real tail) const {
        const Real blend = share * tail + (1 - share) * rough_moment_inverse(r);
        // Heavy tails: from below, as each part alone is smaller than the sum.
        const Real below =
            elementary::max(rough_tail_inverse(elementary::min(Real{1}, r / share)),
                            rough_moment_inverse(elementary::min(Real{1}, r / (1 - share))));
        return heavy_ * below + (1 - heavy_) * blend;
    }
    Real hidden(Real p, Real q) const {
        const Real a = p / q, root = std::sqrt(q * q + p * p * inv_k_);
        const Real power = elementary::exp(-k_ * elementary::log1p(a * a * inv_k_));
        return moment_ * power * root * hidden_factor(p, root);
    }

private:
    static constexpr std::size_t count = std::same_as<Real, float> ? 14 : 26;

    Real rough_moment_inverse(Real r) const {
        return flat_to_slope(-elementary::log(r) * k_ / (k_ - Real{0.5}));
    }
    /// tail / (1 + z^2 / k)^-k at z, root = sqrt(1 + z^2 / k); or at p / q with root times q.
    Real tail_factor(Real p, Real root) const {
        return elementary::polynomial(tail_, place(p, root)) * root / (root + p);
    }
    /// hidden(p, q) over q moment(p / q), 1 at p = 0.
    Real hidden_factor(Real p, Real root) const {
        const Real factor = root / (root + p);
        return elementary::polynomial(hidden_, place(p, root)) * factor * factor;
    }
    /// z = p / root in [0, sqrt(k)] as a number in [-1, 1].
    Real place(Real p, Real root) const { return (a_ * p - b_ * root) / (p + b_ * root); }
    /// z with (1 + z^2 / k)^-k = e^-x.
    Real flat_to_slope(Real x) const {
        return std::sqrt(k_ * elementary::expm1(elementary::min(x * inv_k_, largest_exponent)));
    }
    static constexpr Real largest_exponent = 55;

    Real k_, inv_k_, c_, moment_, a_, b_;
    /// 1 for heavy tails, else 0.
    Real heavy_;
    std::array<Real, count> tail_, hidden_;
};

/// Student's t-distribution of slopes (STD): between heavier tails than GGX for small gamma, GGX
/// at gamma = 2 and Beckmann for gamma to infinity. Its P22 is
/// (1 + s^2 / ((gamma - 1) alpha^2))^-gamma / (pi alpha^2), s^2 = slope_x^2 + slope_y^2: a mixture
/// of Beckmann distributions whose 1 / alpha^2 are Gamma-distributed, and under a stretch the
/// distribution cos^n of directions, from which the masking and the visible normals follow.
///
/// "STD: Student's t-Distribution of Slopes for Microfacet Based BSDFs" (Ribardiere et al. 2017);
/// this gamma is not that of GTR.
template <std::floating_point R>
class STD : public SlopeDistribution<STD<R>, R> {
public:
    using Real = R;
    /// Free of branches: arrays are evaluated in vectors.
    static constexpr bool vectorizes = true;

    /// Throws InvalidInput unless alpha is in [1e-6, 1e6] and gamma in [1.51, 1e9]; at 3/2 masking
    /// becomes total.
    STD(double alpha, double gamma)
        : alpha_(static_cast<Real>(require_range("alpha", alpha, smallest_alpha, largest_alpha))),
          k_(static_cast<Real>(require_range("gamma", gamma, 1.51, 1e9) - 1)),
          inv_k_(static_cast<Real>(1 / (gamma - 1))),
          gamma_(gamma),
          along_(gamma - 1),
          across_(gamma - 0.5) {}

    Real alpha() const { return alpha_; }
    double gamma() const { return gamma_; }

    Real P22(const Slope<Real>& slope) const { return D(Direction<Real>{-slope.x, -slope.y, 1}); }

    /// Also takes a vector of any length, at which P22 is D.
    Real D(const Direction<Real>& m) const {
        const Real x = m.x / alpha_, y = m.y / alpha_, rest = (x * x + y * y) * inv_k_;
        const Real z2 = m.z * m.z, sum = z2 + rest;
        const Real power =
            elementary::exp((1 - k_) * elementary::log1p(rest / elementary::max(z2, tiny)));
        const Real value = std::numbers::inv_pi_v<Real> / (alpha_ * alpha_) * power / (sum * sum);
        return m.z > 0 ? value : Real{0};
    }

    Real D_any_length(const Direction<Real>& m) const { return D(m); }

    /// Exact: 1e-12 in double, 1e-6 in float, of 1 + Lambda.
    Real Lambda(const Direction<Real>& v) const { return hidden_area(v) / v.z; }
    Real projected_area(const Direction<Real>& v) const { return v.z + hidden_area(v); }

    Direction<Real> sample_any_length(const Uniform<Real>& u) const {
        const auto [cosine, sine] = elementary::turn(u.y);
        const Real x = -elementary::log(1 - detail::open_uniform(u.x)) * inv_k_;
        const Real radius = alpha_ * std::sqrt(k_ * elementary::expm1(x));
        return {radius * cosine, radius * sine, 1};
    }

    /// Inverts the distribution function of the visible slopes: Student's along the view's azimuth,
    /// times what faces the view; across it Student's of the next half power.
    Direction<Real> sample_visible_any_length(const Direction<Real>& v,
                                              const Uniform<Real>& u) const {
        constexpr bool is_float = std::same_as<Real, float>;
        const Real horizontal = std::sqrt(v.x * v.x + v.y * v.y);
        const Real flat = 1 / elementary::max(horizontal, tiny);
        const Real cosine = horizontal > 0 ? v.x * flat : Real{1}, sine = v.y * flat;
        const Real scale = 1 / elementary::max(alpha_ * horizontal, v.z);
        const Real x =
            visible_slope<is_float ? 4 : 7>(along_, v.z * scale, alpha_ * horizontal * scale, u.x);
        const Real y = slope_quantile<is_float ? 2 : 4>(across_, u.y) *
                       std::sqrt((1 + x * x * inv_k_) * k_ / (k_ + Real{0.5}));
        return {-alpha_ * (cosine * x - sine * y), -alpha_ * (sine * x + cosine * y), 1};
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        return normalized(sample_any_length(u));
    }
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return normalized(sample_visible_any_length(v, u));
    }

private:
    static constexpr Real tiny = std::numeric_limits<Real>::min();

    /// v_z Lambda(v).
    Real hidden_area(const Direction<Real>& v) const {
        return along_.hidden(v.z, alpha_ * std::sqrt(v.x * v.x + v.y * v.y)) / 2;
    }

    Real alpha_, k_, inv_k_;
    double gamma_;
    StudentSlopes<Real> along_, across_;
};

/// The published fit of STD's Lambda for a = 1 / (alpha tan(theta)) and gamma in (1.5, 40]: G1 is
/// up to 0.7 % off (Ribardiere et al. 2017, eq. 13, 14, 22, 23).
LTMD_API double std_lambda_rational(double a, double gamma);

extern template class StudentSlopes<float>;
extern template class StudentSlopes<double>;

extern template LTMD_API AnyDistribution<float>::AnyDistribution(STD<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(STD<double>);

}  // namespace ltmd::inline v0
