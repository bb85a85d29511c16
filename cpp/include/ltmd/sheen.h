// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/require_range.h"
#include "ltmd/visible_normals.h"

namespace ltmd::inline v0 {

/// Lambda of Sheen as its authors fit it (Estevez and Kulla 2017, "Production Friendly Microfacet
/// Sheen BRDF"), for comparison: G1 up to 85 degrees is 2 % off at alpha = 0.1, 11 % at
/// 0.2 and 0.3, 1 % from 0.7 on, and more than twice too large at 0.01. Throws as Sheen.
LTMD_API double sheen_lambda_fit(double alpha, double cosine);

/// The distribution of cloth D = (2 + 1/alpha) sin(theta)^(1/alpha) / (2 pi), most of whose normals
/// are far from the macrosurface's (Estevez and Kulla 2017); Lambda is the tabulated Smith
/// integral.
template <std::floating_point R>
class Sheen : public TabulatedMasking<Sheen<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless alpha is in [1e-3, 1].
    explicit Sheen(double alpha)
        : TabulatedMasking<Sheen, R>(
              tabulated_normals([exponent = 1 / require_range("alpha", alpha, 1e-3, 1)](double r) {
                  const double square = 1 + r * r;
                  return std::exp(-exponent / 2 * std::log1p(1 / (r * r))) / (square * square);
              })),
          alpha_(alpha),
          exponent_(static_cast<Real>(1 / alpha)) {}

    double alpha() const { return alpha_; }

    Real P22(const Slope<Real>& slope) const {
        const Real r2 = slope.x * slope.x + slope.y * slope.y;
        const Real cos2 = 1 / (1 + r2);
        return density(-std::log1p(1 / r2) / 2) * cos2 * cos2;
    }

    Real D(const Direction<Real>& m) const {
        if (!(m.z > 0)) return 0;
        // log(sin) without the cancellation of either form.
        const Real log_square =
            m.z < Real(0.7) ? std::log1p(-m.z * m.z) : std::log(m.x * m.x + m.y * m.y);
        return density(log_square / 2);
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        // sin^(2 + 1/alpha) is uniform.
        const Real log_sine = std::log(u.x) / (2 + exponent_);
        const Real sine = std::exp(log_sine), phi = 2 * std::numbers::pi_v<Real> * u.y;
        return {sine * std::cos(phi), sine * std::sin(phi),
                std::sqrt(std::max(Real{0}, -std::expm1(2 * log_sine)))};
    }

private:
    Real density(Real log_sine) const {
        return (2 + exponent_) * (std::numbers::inv_pi_v<Real> / 2) *
               std::exp(exponent_ * log_sine);
    }

    double alpha_;
    Real exponent_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(Sheen<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(Sheen<double>);

}  // namespace ltmd::inline v0
