// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/require_range.h"
#include "ltmd/visible_normals.h"

namespace ltmd::inline v0 {

/// Schlick's rational approximation of Beckmann with the same m; 0 where cos(theta) < 1 - m
/// (microfacet-distribution-conversion, Table 1).
///
/// With y = (1 - cos) / m, D = (1 - y) / (pi cos (m + (1 - m) y (2 - y))^2).
template <std::floating_point R>
class SchlickMDF : public TabulatedMasking<SchlickMDF<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless m is in [1e-6, 1].
    explicit SchlickMDF(double m)
        : TabulatedMasking<SchlickMDF, R>(tabulated_normals(
              [m = require_range("m", m, 1e-6, 1)](double r) { return P22_at<double>(m, r); })),
          m_(static_cast<Real>(m)) {}

    Real m() const { return m_; }

    Real P22(const Slope<Real>& slope) const {
        return P22_at<Real>(m_, std::hypot(slope.x, slope.y));
    }

    Real D(const Direction<Real>& m) const {
        return m.z > 0 ? density(m_, (m.x * m.x + m.y * m.y) / (1 + m.z), m.z) : Real{0};
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        // 1 - u.x = q / (m + (1 - q) (1 - m)) with q = (1 - y)^2, turned round for y.
        const Real rest = m_ + (1 - u.x) * (1 - m_);
        const Real y = m_ * u.x / (rest * (1 + std::sqrt((1 - u.x) / rest)));
        const Real versine = m_ * y, phi = 2 * std::numbers::pi_v<Real> * u.y;
        const Real sine = std::sqrt(versine * (2 - versine));
        return {sine * std::cos(phi), sine * std::sin(phi), 1 - versine};
    }

private:
    /// D where 1 - cos is `versine`.
    template <class T>
    static T density(T m, T versine, T cosine) {
        // 1 - y from whichever of 1 - cos and cos is known to more digits.
        const T rest = cosine < T(0.5) ? (cosine - (1 - m)) / m : 1 - versine / m;
        if (!(rest > 0)) return 0;
        const T y = versine / m, sum = m + (1 - m) * y * (2 - y);
        return rest * std::numbers::inv_pi_v<T> / (cosine * sum * sum);
    }

    template <class T>
    static T P22_at(T m, T r) {
        const T square = 1 + r * r, cosine = 1 / std::sqrt(square);
        // Where r^2 overflows it is 0 but for m = 1, where it is cos^4 / pi.
        if (!(cosine > 0)) return 0;
        const T versine = r * r * cosine / (square * cosine + 1);
        const T cos2 = cosine * cosine;
        return density(m, versine, cosine) * cos2 * cos2;
    }

    Real m_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(SchlickMDF<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(SchlickMDF<double>);

}  // namespace ltmd::inline v0
