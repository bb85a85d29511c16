// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "ltmd/matrix2.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// A distribution after the map p' = M p of its microsurface, heights kept: LTMD
/// (microsurface-transformations, section 4.2). M may turn, shear and mirror.
template <MicrofacetDistribution Base>
class TransformedDistribution
    : public SlopeDistribution<TransformedDistribution<Base>, typename Base::Real> {
public:
    using Real = typename Base::Real;
    static constexpr bool vectorizes = views_vectorize<Base>;
    static constexpr bool normals_vectorize = ltmd::normals_vectorize<Base>;

    /// Throws InvalidInput, with M's numbers, unless M is finite and invertible (condition at most
    /// 1e6).
    TransformedDistribution(Base base, const Matrix2& m)
        : base_(std::move(base)), matrix_(m), m_(rows(m)), inverse_() {
        require_invertible(m, "M");
        inverse_ = rows(inverse(m));
        area_ = static_cast<Real>(std::abs(determinant(m)));
    }

    const Base& base() const { return base_; }
    const Matrix2& matrix() const { return matrix_; }

    /// |det M| P22(M^T slope) (eq. 24).
    Real P22(const Slope<Real>& slope) const {
        return area_ *
               base_.P22({m_.xx * slope.x + m_.yx * slope.y, m_.xy * slope.x + m_.yy * slope.y});
    }

    /// |det M| / |M^T m|^4 D(u), u = M^T m / |M^T m| (eq. 13, 22).
    Real D(const Direction<Real>& m) const {
        const Direction<Real> u{m_.xx * m.x + m_.yx * m.y, m_.xy * m.x + m_.yy * m.y, m.z};
        if constexpr (requires { base_.D_any_length(u); }) {
            return area_ * base_.D_any_length(u);
        } else {
            const Real length2 = dot(u, u);
            return area_ / (length2 * length2) * base_.D(normalized(u));
        }
    }

    /// Lambda(M^-1 v): masking goes with the surface (eq. 12).
    Real Lambda(const Direction<Real>& v) const { return base_.Lambda(to_base(v)); }

    /// The base's for M^-1 v, not normalised.
    Real projected_area(const Direction<Real>& v) const { return base_.projected_area(to_base(v)); }

    /// M^-T u, normalised, of the base's sample u (eq. 26).
    Direction<Real> sample(const Uniform<Real>& u) const {
        if constexpr (requires { base_.sample_any_length(u); })
            return from_base(base_.sample_any_length(u));
        else
            return from_base(base_.sample(u));
    }

    /// The base's visible normal for M^-1 v, turned by M^-T (eq. 28).
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        if constexpr (requires { base_.sample_visible_any_length(v, u); })
            return from_base(base_.sample_visible_any_length(to_base(v), u));
        else
            return from_base(base_.sample_visible(normalized(to_base(v)), u));
    }

private:
    struct Rows {
        Real xx, xy, yx, yy;
    };
    static Rows rows(const Matrix2& m) {
        return {static_cast<Real>(m.xx), static_cast<Real>(m.xy), static_cast<Real>(m.yx),
                static_cast<Real>(m.yy)};
    }
    Direction<Real> to_base(const Direction<Real>& v) const {
        return {inverse_.xx * v.x + inverse_.xy * v.y, inverse_.yx * v.x + inverse_.yy * v.y, v.z};
    }
    Direction<Real> from_base(const Direction<Real>& u) const {
        return normalized(Direction<Real>{inverse_.xx * u.x + inverse_.yx * u.y,
                                          inverse_.xy * u.x + inverse_.yy * u.y, u.z});
    }

    Base base_;
    Matrix2 matrix_;
    Rows m_, inverse_;
    Real area_;
};

/// `base` under M; a distribution that is transformed already takes the product of both matrices.
template <MicrofacetDistribution Base>
TransformedDistribution<Base> transformed(Base base, const Matrix2& m) {
    return {std::move(base), m};
}
template <MicrofacetDistribution Base>
TransformedDistribution<Base> transformed(const TransformedDistribution<Base>& once,
                                          const Matrix2& m) {
    return {once.base(), m * once.matrix()};
}

}  // namespace ltmd::inline v0
