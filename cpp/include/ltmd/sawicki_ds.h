// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/require_range.h"
#include "ltmd/visible_normals.h"

namespace ltmd::inline v0 {

/// Sawicki's rational approximation D_DS of Beckmann with parameter N_DS
/// (microfacet-distribution-conversion, Table 1).
///
/// D = 3 (3 + N) cos / (8 pi (1 + (N - 1) (1 - cos) / 4)^4).
template <std::floating_point R>
class SawickiDS : public TabulatedMasking<SawickiDS<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless N is in [0.01, 1e13].
    explicit SawickiDS(double N)
        : TabulatedMasking<SawickiDS, R>(tabulated_normals(
              [N = require_range("N", N, 0.01, 1e13)](double r) { return P22_at<double>(N, r); })),
          N_(static_cast<Real>(N)) {}

    Real N() const { return N_; }

    Real P22(const Slope<Real>& slope) const {
        return P22_at<Real>(N_, std::hypot(slope.x, slope.y));
    }

    Real D(const Direction<Real>& m) const {
        return m.z > 0 ? density(N_, (m.x * m.x + m.y * m.y) / (1 + m.z), m.z) : Real{0};
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        // (4 cos / (4 + (N - 1) (1 - cos)))^3 is uniform.
        const Real t = std::cbrt(1 - u.x);
        const Real above = 4 * u.x / (1 + t + t * t);
        const Real versine = std::min(Real{1}, above / (4 + t * (N_ - 1)));
        const Real sine = std::sqrt(versine * (2 - versine));
        const Real phi = 2 * std::numbers::pi_v<Real> * u.y;
        return {sine * std::cos(phi), sine * std::sin(phi), 1 - versine};
    }

private:
    template <class T>
    static T density(T N, T versine, T cosine) {
        const T root = 1 + (N - 1) * versine / 4;
        const T square = root * root;
        // In this order nothing overflows.
        return (3 + N) / square * (3 * std::numbers::inv_pi_v<T> / 8 * cosine / square);
    }

    template <class T>
    static T P22_at(T N, T r) {
        const T square = 1 + r * r, cosine = 1 / std::sqrt(square);
        if (!(cosine > 0)) return 0;
        const T versine = r * r * cosine / (square * cosine + 1);
        const T cos2 = cosine * cosine;
        return density(N, versine, cosine) * cos2 * cos2;
    }

    Real N_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(SawickiDS<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(SawickiDS<double>);

}  // namespace ltmd::inline v0
