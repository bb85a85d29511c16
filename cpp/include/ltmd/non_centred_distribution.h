// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <utility>

#include "ltmd/ellipsoid_ndf.h"
#include "ltmd/require_range.h"
#include "ltmd/transformed_distribution.h"

namespace ltmd::inline v0 {

/// A centred distribution with all of its slopes moved by an offset: its microsurface sheared
/// vertically, z' = z + offset . p (masking-shadowing, section 5.5, eq. 94-97). The plane of the
/// mean slope is the mesosurface.
///
/// Masking does not change by the shear: among the microfacets that face v, mesosurface_G1(v) are
/// visible, and their projected area is mesosurface_area(v), which takes the place of v_z. G1 and
/// Lambda have that factor in them, so that the weak white furnace holds over the macrosurface's
/// area v_z as for every other distribution, cut at G1 = 1 (ellipsoid-ndf, eq. 31, 32): where less
/// than v_z faces v the furnace gives less than 1.
///
/// `Base` must be centred, its mean slope 0; of this one and of an EllipsoidNDF, which need not be,
/// sheared() adds the offsets.
template <MicrofacetDistribution Base>
class NonCentredDistribution
    : public SlopeDistribution<NonCentredDistribution<Base>, typename Base::Real> {
public:
    using Real = typename Base::Real;

    /// Throws InvalidInput unless both of the offset's slopes are in [-1e6, 1e6].
    NonCentredDistribution(Base base, const Slope<double>& offset)
        : base_(std::move(base)), offset_(offset) {
        require_range("offset_x", offset.x, -largest_offset, largest_offset);
        require_range("offset_y", offset.y, -largest_offset, largest_offset);
        s_ = {static_cast<Real>(offset.x), static_cast<Real>(offset.y)};
    }

    const Base& base() const { return base_; }
    const Slope<double>& offset() const { return offset_; }

    /// The base's at slope - offset (eq. 95).
    Real P22(const Slope<Real>& slope) const { return base_.P22({slope.x - s_.x, slope.y - s_.y}); }

    Real D(const Direction<Real>& m) const {
        const Direction<Real> u{m.x + s_.x * m.z, m.y + s_.y * m.z, m.z};
        const Real length2 = dot(u, u);
        return base_.D(normalized(u)) / (length2 * length2);
    }

    /// projected_area(v) / v_z - 1, or 0 where that is negative.
    Real Lambda(const Direction<Real>& v) const {
        const Direction<Real> w = to_base(v);
        const Real excess = faces(w) ? w.z * base_.Lambda(w) + (w.z - v.z) : area_below(w) - v.z;
        return std::max(Real{0}, excess) / v.z;
    }

    /// The area of the microfacets that face v, projected along v.
    Real projected_area(const Direction<Real>& v) const {
        const Direction<Real> w = to_base(v);
        return faces(w) ? base_.projected_area(w) : area_below(w);
    }

    /// The mesosurface's normal times v over its normal times the macrosurface's: the projected
    /// area of what is visible, 0 if the mesosurface faces away (section 5.5).
    Real mesosurface_area(const Direction<Real>& v) const {
        return std::max(Real{0}, to_base(v).z);
    }

    /// The part of the microfacets facing v that is visible, by the base's masking of the slope of
    /// v less the offset (eq. 96); 0 if the mesosurface or the macrosurface faces away.
    Real mesosurface_G1(const Direction<Real>& v) const {
        const Direction<Real> w = to_base(v);
        return v.z > 0 && faces(w) ? 1 / (1 + base_.Lambda(w)) : Real{0};
    }

    Direction<Real> sample(const Uniform<Real>& u) const { return from_base(base_.sample(u)); }

    /// The base's visible normals for the sheared v. Where the mesosurface faces away they come by
    /// rejection from those at its horizon, with random numbers hashed from u; where less than
    /// 1/512 of those would do, one normal that just faces v stands for all.
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        const Direction<Real> w = to_base(v);
        return from_base(faces(w) ? base_.sample_visible(normalized(w), u) : sample_below(w, u));
    }

private:
    static constexpr double largest_offset = 1e6;
    /// Views of w_z / |w_xy| below this count as the horizon's: bases take views above it.
    static constexpr Real horizon = std::numeric_limits<Real>::epsilon();
    static constexpr int rarest = 512;

    static Real across(const Direction<Real>& w) { return std::sqrt(w.x * w.x + w.y * w.y); }
    static bool faces(const Direction<Real>& w) { return w.z > horizon * across(w); }

    /// The area that faces a view w below the mesosurface. Of a centred distribution the areas that
    /// face w and -w, each projected along it, differ by w_z.
    Real area_below(const Direction<Real>& w) const {
        const Real z = std::max(-w.z, horizon * across(w));
        return z * base_.Lambda({-w.x, -w.y, z});
    }

    Direction<Real> sample_below(const Direction<Real>& w, Uniform<Real> u) const {
        const Real rim = across(w);
        const Direction<Real> edge{w.x, w.y, horizon * rim};
        if (area_below(w) * rarest > base_.projected_area(edge)) {
            const Direction<Real> level = normalized(edge);
            std::uint64_t state = std::bit_cast<std::uint64_t>(static_cast<double>(u.x)) * 3 +
                                  std::bit_cast<std::uint64_t>(static_cast<double>(u.y));
            for (int i = 0; i < 8 * rarest; ++i) {
                const Direction<Real> m = base_.sample_visible(level, u);
                if (const Real facing = dot(w, m); facing > random(state) * dot(edge, m)) return m;
                u = {random(state), random(state)};
            }
        }
        const Real slope = static_cast<Real>(1.125) * w.z / (rim * rim);
        return normalized(Direction<Real>{-slope * w.x, -slope * w.y, 1});
    }

    /// The next number in [0, 1) of the generator SplitMix64.
    static Real random(std::uint64_t& state) {
        state += 0x9e3779b97f4a7c15;
        std::uint64_t z = state;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        z ^= z >> 31;
        constexpr int bits = std::numeric_limits<Real>::digits;
        return static_cast<Real>(z >> (64 - bits)) / static_cast<Real>(std::uint64_t{1} << bits);
    }

    Direction<Real> to_base(const Direction<Real>& v) const {
        return {v.x, v.y, v.z - (s_.x * v.x + s_.y * v.y)};
    }
    Direction<Real> from_base(const Direction<Real>& u) const {
        return normalized(Direction<Real>{u.x - s_.x * u.z, u.y - s_.y * u.z, u.z});
    }

    Base base_;
    Slope<double> offset_;
    Slope<Real> s_;
};

/// `base` sheared vertically, every slope moved by `offset`; offsets add. Throws as
/// NonCentredDistribution, or Ellipsoid::sheared.
template <MicrofacetDistribution Base>
NonCentredDistribution<Base> sheared(Base base, const Slope<double>& offset) {
    return {std::move(base), offset};
}
template <MicrofacetDistribution Base>
NonCentredDistribution<Base> sheared(const NonCentredDistribution<Base>& once,
                                     const Slope<double>& offset) {
    return {once.base(), {once.offset().x + offset.x, once.offset().y + offset.y}};
}
template <std::floating_point Real>
EllipsoidNDF<Real> sheared(const EllipsoidNDF<Real>& base, const Slope<double>& offset) {
    return EllipsoidNDF<Real>(base.ellipsoid().sheared(offset));
}

/// A sheared distribution under M is the base under M, with the offset M^-T offset.
template <MicrofacetDistribution Base>
auto transformed(const NonCentredDistribution<Base>& base, const Matrix2& m) {
    require_invertible(m, "M");
    const Matrix2 i = inverse(m);
    const Slope<double>& s = base.offset();
    return sheared(transformed(base.base(), m), {i.xx * s.x + i.yx * s.y, i.xy * s.x + i.yy * s.y});
}

}  // namespace ltmd::inline v0
