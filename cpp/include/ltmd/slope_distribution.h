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
///
/// A distribution may save TransformedDistribution the normalising with D_any_length(m),
/// D(m / |m|) / |m|^4, and with sample_any_length(u) and sample_visible_any_length(v, u), whose v
/// and normals have any length.
///
/// One whose members have no branches, call nothing that is not inline and take any input may say
/// `static constexpr bool vectorizes = true;` then AnyDistribution evaluates arrays in vectors.
/// Where that is so of P22, D and sample but not of what takes a view, it is `normals_vectorize`.
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

template <class T>
inline constexpr bool views_vectorize = requires { requires T::vectorizes; };
template <class T>
inline constexpr bool normals_vectorize =
    views_vectorize<T> || requires { requires T::normals_vectorize; };

/// The functions that follow from the four members above. A distribution may define its own D or
/// projected_area where that is more exact.
template <class Derived, std::floating_point R>
class SlopeDistribution {
public:
    using Real = R;

    /// D(m) = P22(slope) / cos^4(theta_m), per steradian; 0 for m_z <= 0
    /// (microsurface-transformations, eq. 4).
    Real D(const Direction<Real>& m) const {
        return where(m.z > 0, [&] {
            const Real cos2 = m.z * m.z;
            // At the horizon P22 vanishes.
            return self().P22(slope_of(m)) /
                   std::max(cos2 * cos2, std::numeric_limits<Real>::min());
        });
    }

    /// The masking G1(v) = 1 / (1 + Lambda(v)) in [0, 1] of microfacets that face v; 0 for
    /// v_z <= 0 (masking-shadowing, eq. 43).
    Real G1(const Direction<Real>& v) const {
        return where(v.z > 0, [&] { return 1 / (1 + self().Lambda(v)); });
    }

    /// The area of the microfacets that face v, projected along v: the integral of
    /// D(m) max(0, v.m), v_z (1 + Lambda(v)); grows with the length of v.
    Real projected_area(const Direction<Real>& v) const {
        return where(v.z > 0, [&] { return v.z * (1 + self().Lambda(v)); });
    }

    /// The density of sample(), D(m) cos(theta_m), per steradian.
    Real pdf(const Direction<Real>& m) const {
        return where(m.z > 0, [&] { return self().D(m) * m.z; });
    }

    /// The density of sample_visible(), D(m) max(0, v.m) / projected_area(v), per steradian; 0 for
    /// v_z <= 0 (microsurface-transformations, eq. 27).
    Real pdf_visible(const Direction<Real>& v, const Direction<Real>& m) const {
        const Real facing = dot(v, m);
        return where(v.z > 0 && facing > 0,
                     [&] { return self().D(m) * facing / self().projected_area(v); });
    }

private:
    const Derived& self() const { return static_cast<const Derived&>(*this); }

    /// value() if valid, else 0; where there shall be no branches, value() is called anyway.
    template <class Value>
    static Real where(bool valid, const Value& value) {
        if constexpr (normals_vectorize<Derived>) {
            const Real computed = value();
            return valid ? computed : Real{0};
        } else {
            return valid ? value() : Real{0};
        }
    }
};

/// The slope scales that the distributions take: below, a float's D overflows.
inline constexpr double smallest_alpha = 1e-6, largest_alpha = 1e6;

}  // namespace ltmd::inline v0
