// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ltmd/any_distribution.h"
#include "ltmd/export.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// Masking and sampling behind AshikhminShirley.
///
/// Slopes are stretched: s = t (cos(xi) / sqrt(nx + 2), sin(xi) / sqrt(ny + 2)). Then xi is uniform
/// and t exceeds a value with probability (1 + k t^2)^(-1 / (2 k)), with k(xi) = cos^2(xi) / (nx +
/// 2)
/// + sin^2(xi) / (ny + 2): nearly a Gaussian, and nearly isotropic for every pair of exponents. The
/// shares of lines through the origin in the visible area are tabulated over the stretched view, as
/// in VisibleNormals; projected areas and the density of visible normals are within 1e-5.
class AshikhminShirleyNormals {
public:
    LTMD_API AshikhminShirleyNormals(double nx, double ny);

    LTMD_API double projected_area(const Direction<double>& v) const;
    LTMD_API Slope<double> sample(const Uniform<double>& u) const;
    LTMD_API Slope<double> sample_visible(const Direction<double>& v,
                                          const Uniform<double>& u) const;

private:
    struct View;
    View view_of(const Direction<double>& v) const;
    double excess_area(const View& view) const;
    double share(const View& view, std::size_t k) const;
    double k_at(double xi) const;
    std::size_t row(std::size_t turn, std::size_t j) const { return turn * cotangents_ + j; }

    double alpha_x_, alpha_y_;
    double log_low_;
    std::size_t cotangents_;
    // For each angle of the view and each cotangent.
    std::vector<double> excess_area_, above_, share_;
};

/// Ashikhmin and Shirley's anisotropic Phong distribution D = sqrt((nx + 2) (ny + 2)) / (2 pi)
/// cos(theta)^(nx cos^2(phi) + ny sin^2(phi)) (microfacet-distribution-conversion, Table 1): the
/// form of which D cos integrates to 1. Its first publication has + 1 in place of + 2: there D
/// does. Not a linear transform of Phong.
template <std::floating_point R>
class AshikhminShirley : public SlopeDistribution<AshikhminShirley<R>, R> {
public:
    using Real = R;

    /// Throws InvalidInput unless both are in [0.01, 1e13].
    AshikhminShirley(double nx, double ny)
        : nx_(static_cast<Real>(require_range("nx", nx, 0.01, 1e13))),
          ny_(static_cast<Real>(require_range("ny", ny, 0.01, 1e13))),
          peak_(static_cast<Real>(std::sqrt((nx + 2) * (ny + 2)) * std::numbers::inv_pi / 2)),
          normals_(std::make_shared<const AshikhminShirleyNormals>(nx, ny)) {}

    Real nx() const { return nx_; }
    Real ny() const { return ny_; }

    Real P22(const Slope<Real>& slope) const {
        const Real r2 = slope.x * slope.x + slope.y * slope.y;
        const Real log_square = std::log1p(r2);
        const Real power = nx_ * slope.x * slope.x + ny_ * slope.y * slope.y;
        const Real ratio = r2 > 0 ? log_square / r2 : Real{1};
        const Real exponent = power * ratio / 2 + 2 * log_square;
        // Not a number where slopes overflow.
        return exponent >= 0 ? peak_ * std::exp(-exponent) : Real{0};
    }

    Real D(const Direction<Real>& m) const {
        if (!(m.z > 0)) return 0;
        const Real x2 = m.x * m.x, y2 = m.y * m.y, across2 = x2 + y2;
        if (!(across2 > 0)) return peak_;
        // log(cos) is small near the normal: from the slope there.
        const Real log_cosine =
            m.z < Real(0.5) ? std::log(m.z) : std::log1p(across2 / (m.z * m.z)) / -2;
        return peak_ * std::exp((nx_ * (x2 / across2) + ny_ * (y2 / across2)) * log_cosine);
    }

    Real Lambda(const Direction<Real>& v) const {
        const double z = v.z;
        return static_cast<Real>(std::max(0.0, normals_->projected_area({v.x, v.y, z}) / z - 1));
    }

    Real projected_area(const Direction<Real>& v) const {
        return v.z > 0 ? static_cast<Real>(normals_->projected_area({v.x, v.y, v.z})) : Real{0};
    }

    Direction<Real> sample(const Uniform<Real>& u) const {
        return to_real(normals_->sample({u.x, u.y}));
    }

    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return to_real(normals_->sample_visible({v.x, v.y, v.z}, {u.x, u.y}));
    }

private:
    static Direction<Real> to_real(const Slope<double>& slope) {
        const Direction<double> m = normal_of(slope);
        return {static_cast<Real>(m.x), static_cast<Real>(m.y), static_cast<Real>(m.z)};
    }

    Real nx_, ny_, peak_;
    std::shared_ptr<const AshikhminShirleyNormals> normals_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(AshikhminShirley<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(AshikhminShirley<double>);

}  // namespace ltmd::inline v0
