// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ltmd/export.h"
#include "ltmd/slope_distribution.h"

/// Masking and sampling of isotropic distributions that have no closed form for them.
namespace ltmd::inline v0 {

/// An isotropic P22 over the slope r = tan(theta), quadratic in r between nodes and 0 beyond the
/// last, with the integrals of P22 r and P22 r^2 from any r to infinity. All of it belongs exactly
/// to that interpolant, which integrates to 1.
class RadialTable {
public:
    using Function = std::function<std::vector<double>(const std::vector<double>&)>;

    /// Linear between the given slopes, constant below the first; any scale. Throws InvalidInput
    /// unless there are two slopes or more, increasing within [0, 1e12], and densities that are
    /// finite, at least 0 and not all 0.
    LTMD_API RadialTable(std::span<const double> r, std::span<const double> p22);

    /// A function of slopes, of any scale. Nodes are added until the interpolant is within 1e-6 of
    /// it or adds less than 1e-8 to the mean slope and to the integral; slopes up to 1e12 count.
    /// Throws InvalidInput, naming slope and density, where the function is negative or not
    /// finite, and if it integrates to 0.
    LTMD_API explicit RadialTable(const Function& p22);

    /// The slopes between which P22 is a polynomial.
    const std::vector<double>& nodes() const { return r_; }

    LTMD_API double P22(double r) const;

    /// The integral of P22 t (t - r) over slopes t > r.
    LTMD_API double excess(double r) const;

    /// The integral of P22 t over slopes t > r, and of P22 t^2.
    struct Tail {
        double area, moment;
    };
    LTMD_API Tail tail(double r) const;

    /// The slope r at which area_weight tail(r).area + moment_weight tail(r).moment is `value`;
    /// the sum must fall as r grows from `low` to `high`.
    LTMD_API double solve(double area_weight, double moment_weight, double value, double low,
                          double high) const;

private:
    RadialTable() = default;
    struct Partial;
    Partial partial(std::size_t cell, double t) const;
    std::size_t cell_of(double r) const;
    void add_node(double r, double p22);
    void integrate();

    // Cell k: P22 = p_[k] + (p_[k+1] - p_[k]) t + bump_[k] t (1 - t), t in [0, 1] from r_[k] to
    // r_[k+1].
    std::vector<double> r_, p_, bump_;
    std::vector<Tail> tail_;
};

/// Smith's masking and visible normals of a RadialTable.
///
/// Slopes are taken along lines through the origin at the angle phi to the view. With c the view's
/// cotangent and E(r) = excess(r), the line's share of the visible area is c / pi + cos(phi)
/// E(c / cos(phi)); along the line the slope's distribution follows from the table's tails. The
/// integral over phi is tabulated over ln c and phi; the projected area and the density of visible
/// normals that come of it are within 1e-6 of the table's, or within 1e-5 where P22 has features
/// narrower than a tenth of their slope. Lambda is 0 where it is below 1e-9.
class VisibleNormals {
public:
    LTMD_API explicit VisibleNormals(RadialTable table);

    const RadialTable& table() const { return table_; }

    /// c Lambda at the view's cotangent c: the integral of P22(s) max(0, s_x - c).
    LTMD_API double excess_area(double c) const;

    /// A slope with density P22.
    LTMD_API Slope<double> sample(const Uniform<double>& u) const;

    /// A slope with density P22(s) max(0, v_z - v_x s_x - v_y s_y) / projected_area(v).
    LTMD_API Slope<double> sample_visible(const Direction<double>& v,
                                          const Uniform<double>& u) const;

private:
    struct Row;
    Row row_at(double c) const;
    double share(const Row& row, std::size_t k) const;

    RadialTable table_;
    double log_low_, log_step_;
    std::vector<double> c_, excess_area_, above_;  // of each row: c, excess_area(c), P(s_x > c)
    std::vector<double> share_;  // of each row, the part of excess_area with |phi| below a node
};

/// The VisibleNormals of a function of the slope; throws as RadialTable.
LTMD_API std::shared_ptr<const VisibleNormals> tabulated_normals(
    const std::function<double(double)>& p22);

/// Lambda, projected_area and the samplers of an isotropic distribution that has P22 in closed
/// form, or none but the table's; by VisibleNormals in double whatever Real is.
template <class Derived, std::floating_point R>
class TabulatedMasking : public SlopeDistribution<Derived, R> {
public:
    using Real = R;

    Real Lambda(const Direction<Real>& v) const {
        const double c = cotangent(v);
        return static_cast<Real>(normals_->excess_area(c) / c);
    }

    Real projected_area(const Direction<Real>& v) const {
        if (!(v.z > 0)) return 0;
        return static_cast<Real>(v.z + across(v) * normals_->excess_area(cotangent(v)));
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        return to_real(normals_->sample({u.x, u.y}));
    }

    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return to_real(normals_->sample_visible({v.x, v.y, v.z}, {u.x, u.y}));
    }

protected:
    explicit TabulatedMasking(std::shared_ptr<const VisibleNormals> normals)
        : normals_(std::move(normals)) {}

    const VisibleNormals& normals() const { return *normals_; }

private:
    static double across(const Direction<Real>& v) {
        return std::hypot(static_cast<double>(v.x), static_cast<double>(v.y));
    }
    static double cotangent(const Direction<Real>& v) { return v.z / across(v); }
    static Direction<Real> to_real(const Slope<double>& slope) {
        const Direction<double> m = normal_of(slope);
        return {static_cast<Real>(m.x), static_cast<Real>(m.y), static_cast<Real>(m.z)};
    }

    std::shared_ptr<const VisibleNormals> normals_;
};

}  // namespace ltmd::inline v0
