// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ltmd/any_distribution.h"
#include "ltmd/export.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// Facets with normals drawn from GGX, each spread uniformly over a spherical cap: the realisation
/// behind DiscreteGGX, with its integrals in closed form.
///
/// All caps have one half-angle, lie above the horizon and have one projected area, so that the
/// integral of D cos is 1. A tree over the normals adds up the caps that a query holds whole.
class DiscreteFacets {
public:
    /// Throws InvalidInput as DiscreteGGX.
    LTMD_API DiscreteFacets(double alpha, double facets, double cone, std::uint64_t seed);

    /// The centres of the caps, in the order of sampling.
    const std::vector<Direction<double>>& normals() const { return normals_; }

    LTMD_API double D(const Direction<double>& m) const;
    /// The integral of D(m) max(0, v.m) for v of length 1.
    LTMD_API double projected_area(const Direction<double>& v) const;
    LTMD_API Direction<double> sample(const Uniform<double>& u) const;
    LTMD_API Direction<double> sample_visible(const Direction<double>& v,
                                              const Uniform<double>& u) const;

private:
    /// The facets [begin, end) in a ball, and their sums; children of node i: i + 1 and `second`.
    struct Node {
        Direction<double> centre;
        double radius;
        double density;               // sum of D inside the caps
        Direction<double> projected;  // dot(v, projected): projected area of caps that face v whole
        std::uint32_t begin, end, second;
    };
    struct View;

    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    double density_of(const Direction<double>& normal) const;
    double area(const View& view, std::uint32_t node) const;
    double facet_area(const View& view, std::uint32_t facet) const;
    Direction<double> sample_cap(const View& view, const Direction<double>& normal,
                                 const Uniform<double>& u) const;

    double sine_, cosine_, chord_;  // of the cone; the chord from its axis to its side
    std::vector<Direction<double>> normals_;
    std::vector<Node> nodes_;
};

/// Discrete GGX: `facets` normals drawn from GGX(alpha), each a uniform spherical cap of half-angle
/// `cone`, as glints of a surface with few mirrors; the same for the same seed
/// (microsurface-transformations, section 4.3, after Jakob et al. 2014).
///
/// GGX's normals within `cone` of the horizon are left out, so that D is 0 below it. Evaluated in
/// double whatever Real is; D takes time as the caps around m's border, masking and sample_visible
/// as the caps at the border of the visible half.
template <std::floating_point R>
class DiscreteGGX : public SlopeDistribution<DiscreteGGX<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless alpha is in [1e-6, 1e6], facets, a whole number, in [1, 1e7], and
    /// cone in [1e-3, 1] radians.
    DiscreteGGX(double alpha, double facets, double cone, std::uint64_t seed)
        : DiscreteGGX(std::make_shared<const DiscreteFacets>(alpha, facets, cone, seed)) {}
    explicit DiscreteGGX(std::shared_ptr<const DiscreteFacets> facets)
        : facets_(std::move(facets)) {}

    const DiscreteFacets& facets() const { return *facets_; }

    Real P22(const Slope<Real>& slope) const {
        const Direction<double> m = normal_of(Slope<double>{slope.x, slope.y});
        const double cos2 = m.z * m.z;
        return cos2 > 0 ? static_cast<Real>(facets_->D(m) * cos2 * cos2) : Real{0};
    }

    Real D(const Direction<Real>& m) const {
        return m.z > 0 ? static_cast<Real>(facets_->D({m.x, m.y, m.z})) : Real{0};
    }

    Real Lambda(const Direction<Real>& v) const {
        const Direction<double> unit = normalized(Direction<double>{v.x, v.y, v.z});
        return static_cast<Real>(std::max(0.0, facets_->projected_area(unit) / unit.z - 1));
    }

    Real projected_area(const Direction<Real>& v) const {
        if (!(v.z > 0)) return 0;
        const Direction<double> full{v.x, v.y, v.z};
        return static_cast<Real>(length(full) * facets_->projected_area(normalized(full)));
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        return to_real(facets_->sample(with_all_bits(u)));
    }

    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return to_real(facets_->sample_visible(normalized(Direction<double>{v.x, v.y, v.z}),
                                               with_all_bits(u)));
    }

private:
    /// u.x chooses the facet and, with what is left of it, a place in its cap. A float has too few
    /// bits for both: the rest come from a hash of both numbers.
    static Uniform<double> with_all_bits(const Uniform<Real>& u) {
        constexpr double below_one = 1 - 0x1p-53;
        if constexpr (std::same_as<Real, double>) {
            return {std::min(u.x, below_one), u.y};
        } else {
            auto bits = static_cast<std::uint64_t>(u.x * 0x1p32) ^
                        (static_cast<std::uint64_t>(u.y * 0x1p32) << 32);
            // The finaliser of SplitMix64.
            bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
            bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
            bits ^= bits >> 31;
            const double rest = static_cast<double>(bits >> 40) * 0x1p-48;
            return {std::min(u.x + rest, below_one), u.y};
        }
    }
    static Direction<Real> to_real(const Direction<double>& m) {
        return {static_cast<Real>(m.x), static_cast<Real>(m.y), static_cast<Real>(m.z)};
    }

    std::shared_ptr<const DiscreteFacets> facets_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(DiscreteGGX<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(DiscreteGGX<double>);

}  // namespace ltmd::inline v0
