// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include "ltmd/direction.h"

/// What every microfacet distribution has (microsurface-transformations, section 3.1).
///
/// A microsurface is given by its slope distribution P22, which integrates to 1 over the slopes,
/// and by Smith's masking. Normals m and views v are unit vectors above the surface; the
/// macrosurface normal is (0, 0, 1).
namespace ltmd::inline v0 {

/// What a distribution of one's own provides: a class derived from SlopeDistribution with these
/// four members can be evaluated, sampled and transformed like the library's.
///  - P22(slope): the density of slopes, at least 0.
///  - Lambda(v): Smith's auxiliary function, at least 0, for v_z > 0 and any length of v.
///  - sample(u): a unit normal drawn with density D(m) cos(theta_m).
///  - sample_visible(v, u): a unit normal drawn with density D(m) max(0, v.m) / projected_area(v).
template <class T>
concept MicrofacetDistribution =
    std::floating_point<typename T::Real> &&
    requires(const T& d, const Slope<typename T::Real>& slope, const Direction<typename T::Real>& v,
             const Uniform<typename T::Real>& u) {
        { d.P22(slope) } -> std::same_as<typename T::Real>;
        { d.Lambda(v) } -> std::same_as<typename T::Real>;
        { d.sample(u) } -> std::same_as<Direction<typename T::Real>>;
        { d.sample_visible(v, u) } -> std::same_as<Direction<typename T::Real>>;
    };

/// The functions that follow from the four members above. A distribution may define its own D or
/// projected_area where that is more exact.
template <class Derived, std::floating_point R>
class SlopeDistribution {
public:
    using Real = R;

    /// D(m) = P22(slope) / cos^4(theta_m), per steradian; 0 for m_z <= 0
    /// (microsurface-transformations, eq. 4).
    Real D(const Direction<Real>& m) const {
        if (!(m.z > 0)) return 0;
        const Real cos2 = m.z * m.z;
        return self().P22(slope_of(m)) / (cos2 * cos2);
    }

    /// The masking G1(v) = 1 / (1 + Lambda(v)) in [0, 1] of microfacets that face v; 0 for
    /// v_z <= 0 (masking-shadowing, eq. 43).
    Real G1(const Direction<Real>& v) const {
        return v.z > 0 ? 1 / (1 + self().Lambda(v)) : Real{0};
    }

    /// The area of the microfacets that face v, projected along v: the integral of
    /// D(m) max(0, v.m), v_z (1 + Lambda(v)); grows with the length of v.
    Real projected_area(const Direction<Real>& v) const {
        return v.z > 0 ? v.z * (1 + self().Lambda(v)) : Real{0};
    }

    /// The density of sample(), D(m) cos(theta_m), per steradian.
    Real pdf(const Direction<Real>& m) const { return m.z > 0 ? self().D(m) * m.z : Real{0}; }

    /// The density of sample_visible(), D(m) max(0, v.m) / projected_area(v), per steradian; 0 for
    /// v_z <= 0 (microsurface-transformations, eq. 27).
    Real pdf_visible(const Direction<Real>& v, const Direction<Real>& m) const {
        const Real facing = dot(v, m);
        return v.z > 0 && facing > 0 ? self().D(m) * facing / self().projected_area(v) : Real{0};
    }

private:
    const Derived& self() const { return static_cast<const Derived&>(*this); }
};

/// The slope scales that the distributions take: below, a float's D overflows.
inline constexpr double smallest_alpha = 1e-6, largest_alpha = 1e6;

}  // namespace ltmd::inline v0
