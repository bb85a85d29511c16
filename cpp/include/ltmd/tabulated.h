// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/visible_normals.h"

namespace ltmd::inline v0 {

/// An isotropic distribution given by its P22 alone, as a function of the slope r = tan(theta) or
/// a table: the black box of microsurface-transformations, section 4.5. P22 may have any scale; it
/// is made to integrate to 1. Accuracies are stated at RadialTable and VisibleNormals.
template <std::floating_point R>
class Tabulated : public TabulatedMasking<Tabulated<R>, R> {
public:
    using Real = R;

    explicit Tabulated(std::shared_ptr<const VisibleNormals> normals)
        : TabulatedMasking<Tabulated, R>(std::move(normals)) {}
    /// Throws as RadialTable.
    explicit Tabulated(const std::function<double(double)>& p22)
        : Tabulated(tabulated_normals(p22)) {}
    /// Linear between the slopes r, 0 beyond; throws as RadialTable.
    Tabulated(std::span<const double> r, std::span<const double> p22)
        : Tabulated(RadialTable(r, p22)) {}
    explicit Tabulated(RadialTable table)
        : Tabulated(std::make_shared<const VisibleNormals>(std::move(table))) {}

    Real P22(const Slope<Real>& slope) const {
        return static_cast<Real>(this->normals().table().P22(std::hypot<double>(slope.x, slope.y)));
    }

    Real D(const Direction<Real>& m) const {
        if (!(m.z > 0)) return 0;
        const double x = m.x, y = m.y, z = m.z;
        const double p22 = this->normals().table().P22(std::hypot(x, y) / z);
        // 0 / 0 at the horizon otherwise.
        return p22 > 0 ? static_cast<Real>(p22 / (z * z * z * z)) : Real{0};
    }
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(Tabulated<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(Tabulated<double>);

}  // namespace ltmd::inline v0
