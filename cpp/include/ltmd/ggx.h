// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// The GGX or Trowbridge-Reitz distribution with slope scales alpha_x along U and alpha_y along V
/// (masking-shadowing, eq. 71, 72, 85, 86).
template <std::floating_point R>
class GGX : public SlopeDistribution<GGX<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless both are in [1e-6, 1e6].
    GGX(double alpha_x, double alpha_y)
        : alpha_x_(
              static_cast<Real>(require_range("alpha_x", alpha_x, smallest_alpha, largest_alpha))),
          alpha_y_(
              static_cast<Real>(require_range("alpha_y", alpha_y, smallest_alpha, largest_alpha))) {
    }
    explicit GGX(double alpha) : GGX(alpha, alpha) {}

    Real alpha_x() const { return alpha_x_; }
    Real alpha_y() const { return alpha_y_; }

    Real P22(const Slope<Real>& slope) const { return D({-slope.x, -slope.y, 1}); }

    /// Also takes a vector of any length, at which P22 is D.
    Real D(const Direction<Real>& m) const {
        if (!(m.z > 0)) return 0;
        const Real x = m.x / alpha_x_, y = m.y / alpha_y_;
        const Real sum = x * x + y * y + m.z * m.z;
        return std::numbers::inv_pi_v<Real> / (alpha_x_ * alpha_y_ * sum * sum);
    }

    Real Lambda(const Direction<Real>& v) const {
        const Real x = alpha_x_ * v.x / v.z, y = alpha_y_ * v.y / v.z;
        const Real q = x * x + y * y;
        // (sqrt(1 + q) - 1) / 2 without its cancellation.
        return q / (2 * (1 + std::sqrt(1 + q)));
    }

    Real projected_area(const Direction<Real>& v) const {
        const Direction<Real> stretched{alpha_x_ * v.x, alpha_y_ * v.y, v.z};
        return (v.z + length(stretched)) / 2;
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        const Real phi = 2 * std::numbers::pi_v<Real> * u.y;
        const Real radius = std::sqrt(u.x);
        return normalized(Direction<Real>{alpha_x_ * radius * std::cos(phi),
                                          alpha_y_ * radius * std::sin(phi), std::sqrt(1 - u.x)});
    }

    /// Spherical caps: the visible half of a sphere's normals is a cap of reflected directions.
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        const Direction<Real> w = normalized(Direction<Real>{alpha_x_ * v.x, alpha_y_ * v.y, v.z});
        const Real phi = 2 * std::numbers::pi_v<Real> * u.x;
        // At 1 the normal may vanish.
        const Real height = std::min(u.y, 1 - std::numeric_limits<Real>::epsilon());
        const Real z = (1 - height) * (1 + w.z) - w.z;
        const Real sine = std::sqrt(std::max(Real{0}, (1 - z) * (1 + z)));
        return normalized(Direction<Real>{alpha_x_ * (sine * std::cos(phi) + w.x),
                                          alpha_y_ * (sine * std::sin(phi) + w.y),
                                          std::max(Real{0}, z + w.z)});
    }

private:
    Real alpha_x_, alpha_y_;
};

}  // namespace ltmd::inline v0
