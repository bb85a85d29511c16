// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/elementary.h"
#include "ltmd/lobe_normals.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// The GGX or Trowbridge-Reitz distribution with slope scales alpha_x along U and alpha_y along V
/// (masking-shadowing, eq. 71, 72, 85, 86).
template <std::floating_point R>
class GGX : public SlopeDistribution<GGX<R>, R> {
public:
    using Real = R;
    /// Free of branches: arrays are evaluated in vectors.
    static constexpr bool vectorizes = true;

    /// Throws InvalidInput unless both are in [1e-6, 1e6].
    GGX(double alpha_x, double alpha_y)
        : alpha_x_(
              static_cast<Real>(require_range("alpha_x", alpha_x, smallest_alpha, largest_alpha))),
          alpha_y_(
              static_cast<Real>(require_range("alpha_y", alpha_y, smallest_alpha, largest_alpha))),
          inverse_x_(static_cast<Real>(1 / alpha_x)),
          inverse_y_(static_cast<Real>(1 / alpha_y)),
          area_(std::numbers::pi_v<Real> * alpha_x_ * alpha_y_) {}
    explicit GGX(double alpha) : GGX(alpha, alpha) {}

    Real alpha_x() const { return alpha_x_; }
    Real alpha_y() const { return alpha_y_; }

    Real P22(const Slope<Real>& slope) const { return D({-slope.x, -slope.y, 1}); }

    /// Also takes a vector of any length, at which P22 is D.
    Real D(const Direction<Real>& m) const {
        const Real x = m.x * inverse_x_, y = m.y * inverse_y_;
        const Real sum = x * x + y * y + m.z * m.z;
        const Real value = 1 / (area_ * sum * sum);
        return m.z > 0 ? value : Real{0};
    }

    Real D_any_length(const Direction<Real>& m) const { return D(m); }

    Real Lambda(const Direction<Real>& v) const {
        const Real x = alpha_x_ * v.x / v.z, y = alpha_y_ * v.y / v.z;
        const Real q = x * x + y * y;
        // (sqrt(1 + q) - 1) / 2 without its cancellation.
        return q / (2 * (1 + std::sqrt(1 + q)));
    }

    Real G1(const Direction<Real>& v) const {
        const Real value = elementary::min(Real{1}, v.z / projected_area(v));
        return v.z > 0 ? value : Real{0};
    }

    Real projected_area(const Direction<Real>& v) const {
        const Direction<Real> stretched{alpha_x_ * v.x, alpha_y_ * v.y, v.z};
        return (v.z + length(stretched)) / 2;
    }

    Direction<Real> sample_any_length(const Uniform<Real>& u) const {
        const auto [cosine, sine] = elementary::turn(u.y);
        const Real radius = std::sqrt(u.x);
        return {alpha_x_ * radius * cosine, alpha_y_ * radius * sine, std::sqrt(1 - u.x)};
    }

    Direction<Real> sample_visible_any_length(const Direction<Real>& v,
                                              const Uniform<Real>& u) const {
        const Direction<Real> w = normalized(Direction<Real>{alpha_x_ * v.x, alpha_y_ * v.y, v.z});
        const Direction<Real> m = sample_visible_ggx(w, u);
        return {alpha_x_ * m.x, alpha_y_ * m.y, m.z};
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        return normalized(sample_any_length(u));
    }
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return normalized(sample_visible_any_length(v, u));
    }

private:
    Real alpha_x_, alpha_y_, inverse_x_, inverse_y_, area_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(GGX<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(GGX<double>);

}  // namespace ltmd::inline v0
