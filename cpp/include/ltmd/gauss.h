// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/require_range.h"
#include "ltmd/visible_normals.h"

namespace ltmd::inline v0 {

/// D(0) of Gauss: the integral of exp(-theta^2/m^2) cos over normals is its inverse. Table 1's
/// closed form is approximate, 1.7 % off at m = 0.3.
LTMD_API double gauss_peak(double m);

/// Torrance and Sparrow's Gauss distribution, D proportional to exp(-theta^2 / m^2)
/// (microfacet-distribution-conversion, Table 1), normalised exactly.
template <std::floating_point R>
class Gauss : public TabulatedMasking<Gauss<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless m is in [1e-6, 2].
    explicit Gauss(double m)
        : TabulatedMasking<Gauss, R>(
              tabulated_normals([m = require_range("m", m, 1e-6, 2)](double r) {
                  const double x = std::atan(r) / m, square = 1 + r * r;
                  return std::exp(-x * x) / (square * square);
              })),
          m_(static_cast<Real>(m)),
          peak_(static_cast<Real>(gauss_peak(m))) {}

    Real m() const { return m_; }

    Real P22(const Slope<Real>& slope) const {
        const Real r = std::hypot(slope.x, slope.y);
        const Real cos2 = 1 / (1 + r * r);
        return density(std::atan(r)) * cos2 * cos2;
    }

    Real D(const Direction<Real>& m) const {
        return m.z > 0 ? density(std::atan2(std::hypot(m.x, m.y), m.z)) : Real{0};
    }

private:
    Real density(Real theta) const {
        const Real x = theta / m_;
        return peak_ * std::exp(-x * x);
    }

    Real m_, peak_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(Gauss<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(Gauss<double>);

}  // namespace ltmd::inline v0
