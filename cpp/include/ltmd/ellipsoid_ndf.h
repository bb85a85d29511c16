// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "ltmd/any_distribution.h"
#include "ltmd/export.h"
#include "ltmd/transformed_distribution.h"

namespace ltmd::inline v0 {

/// The ellipsoid |A p| = C_e about the origin (ellipsoid-ndf, eq. 8). Its shape, and with it the
/// distribution of its normals, is the same for c A and for Q A with Q orthogonal, mirrored or not.
/// Functions that need a size take C_e, 1 if left out (eq. 30).
class LTMD_API Ellipsoid {
public:
    /// Row-major, as A of the paper.
    using Matrix = std::array<double, 9>;

    /// Throws InvalidInput, with A's numbers, unless A is finite, its norm |A| in [1e-30, 1e30]
    /// and its condition |A| |A^-1| at most 1e7 (Frobenius norms).
    explicit Ellipsoid(const Matrix& a);

    /// A = diag(alpha_x, alpha_y, 1) R_x(theta_x) R_y(theta_y) R_z(theta_z), rotations in radians,
    /// counter-clockwise seen from the end of their axis (eq. 2, 3). A acts on points, so the
    /// surface itself turns by R's inverse: theta_z turns the axes of alpha_x and alpha_y by
    /// -theta_z about the normal; the peak of D, R's third row if both alphas are below 1, tips by
    /// theta_x > 0 toward +V, by theta_y > 0 toward -U.
    /// Throws InvalidInput unless both alphas are in [1e-6, 1e6], the angles finite and A as above.
    static Ellipsoid from_angles(double alpha_x, double alpha_y, double theta_x, double theta_y,
                                 double theta_z);

    /// An upper triangular A with A^T A = s, the matrix of the SGGX microflake distribution
    /// (section 5.2). Throws InvalidInput unless s is symmetric and positive definite, and A as
    /// above.
    static Ellipsoid from_sggx(const Matrix& s);

    const Matrix& matrix() const { return a_; }
    /// S = A^T A (section 5.2).
    Matrix sggx_matrix() const;

    /// The curvature where the unit normal is m (eq. 20).
    double gaussian_curvature(const Direction<double>& m, double c_e = 1) const;
    /// The area of the whole ellipsoid, projected along u of any length > 0 (eq. 26); grows with
    /// that length.
    double projected_area(const Direction<double>& u, double c_e = 1) const;
    /// The same of the part whose normals face u and also v (eq. 28).
    double lune_area(const Direction<double>& u, const Direction<double>& v, double c_e = 1) const;
    /// The C_e at which the projected area along the macrosurface normal is 1 (eq. 29).
    double unit_size() const;

    /// A^T A n at length 1: the mean normal of the half whose normals face n (section 5.1).
    Direction<double> mean_normal() const;
    Slope<double> mean_slope() const { return mean_slope_; }
    /// K, upper triangular with a positive diagonal: Q A / |A n| = [[K, 0], [-mean_slope^T, 1]].
    Matrix2 slope_matrix() const { return slope_matrix_; }

    /// A M^-1: the ellipsoid of the surface mapped by p' = M p. Throws as the constructor and as
    /// require_invertible.
    Ellipsoid transformed(const Matrix2& m) const;
    /// The ellipsoid of the surface sheared vertically, which moves every slope by `offset`. Throws
    /// as the constructor.
    Ellipsoid sheared(const Slope<double>& offset) const;

private:
    Matrix a_;
    Slope<double> mean_slope_;
    Matrix2 slope_matrix_;
};

/// The ellipsoid NDF (ellipsoid-ndf): the normals of the upper half of an ellipsoid. It may be
/// skewed, with a mean normal beside the macrosurface normal. Over slopes it is a GGX distribution
/// with alpha^2 matrix K^T K about the mean slope; under any M it stays an ellipsoid.
///
/// Masking has the paper's min (eq. 6), so where a skewed ellipsoid's visible area is less than the
/// macrosurface's, the weak white furnace gives less than 1 (eq. 31); it gives 1 everywhere else.
/// All that is used of A is Q A / |A n|, which takes views to where the ellipsoid is a sphere and
/// the macrosurface normal is (0, 0, 1).
template <std::floating_point R>
class EllipsoidNDF : public SlopeDistribution<EllipsoidNDF<R>, R> {
public:
    using Real = R;

    explicit EllipsoidNDF(const Ellipsoid& ellipsoid) : ellipsoid_(ellipsoid) {
        const Matrix2 k = ellipsoid.slope_matrix();
        const Slope<double> s = ellipsoid.mean_slope();
        k_ = {static_cast<Real>(k.xx), static_cast<Real>(k.xy), static_cast<Real>(k.yy)};
        mean_ = {static_cast<Real>(s.x), static_cast<Real>(s.y)};
        shear_ = static_cast<Real>(k.xy / k.xx);
        scale_ = static_cast<Real>(std::numbers::inv_pi / (k.xx * k.yy));
    }
    /// Throws as Ellipsoid.
    explicit EllipsoidNDF(const Ellipsoid::Matrix& a) : EllipsoidNDF(Ellipsoid(a)) {}
    static EllipsoidNDF from_angles(double alpha_x, double alpha_y, double theta_x, double theta_y,
                                    double theta_z) {
        return EllipsoidNDF(Ellipsoid::from_angles(alpha_x, alpha_y, theta_x, theta_y, theta_z));
    }

    const Ellipsoid& ellipsoid() const { return ellipsoid_; }

    Real P22(const Slope<Real>& slope) const { return D({-slope.x, -slope.y, 1}); }

    /// Eq. 1. Also takes a vector of any length, at which P22 is D.
    Real D(const Direction<Real>& m) const {
        if (!(m.z > 0)) return 0;
        const Real x = m.x + mean_.x * m.z, y = m.y + mean_.y * m.z;
        // A^-T m.
        const Real a = x / k_.xx, b = (y - shear_ * x) / k_.yy;
        const Real sum = a * a + b * b + m.z * m.z;
        return scale_ / (sum * sum);
    }

    /// 1/G1 - 1 with the G1 of eq. 6: at least 0.
    Real Lambda(const Direction<Real>& v) const {
        const Direction<Real> w = to_sphere(v);
        const Real len = length(w);
        // projected_area(v) - v_z without its cancellation where w_z is about |w|.
        const Real excess = (w.z > 0 ? (w.x * w.x + w.y * w.y) / (len + w.z) : len - w.z) / 2 -
                            (mean_.x * v.x + mean_.y * v.y);
        return std::max(Real{0}, excess) / v.z;
    }

    /// G1 of eq. 6 without the min: above 1 where the visible area of a skewed ellipsoid is less
    /// than the macrosurface's; with it the weak white furnace gives 1 everywhere. 0 for v_z <= 0.
    Real unclamped_G1(const Direction<Real>& v) const {
        return v.z > 0 ? v.z / projected_area(v) : Real{0};
    }

    /// The ellipsoidal lune's over the ellipsoid's projected area (eq. 28 over eq. 26), with which
    /// pdf_visible is eq. 33.
    Real projected_area(const Direction<Real>& v) const {
        const Direction<Real> w = to_sphere(v);
        return lune_area(w, length(w));
    }

    /// The visible normals from the macrosurface normal, where the lune is the half sphere.
    Direction<Real> sample(const Uniform<Real>& u) const {
        const Disk disk = concentric(u);
        return from_sphere({-disk.x, -disk.y, std::sqrt((1 - disk.radius) * (1 + disk.radius))});
    }

    /// Section 4.1.
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        // (a) A point on the unit disk.
        const Disk disk = concentric(u);
        // (b) The disk compressed to the crescent which the spherical lune projects to.
        const Direction<Real> w = to_sphere(v);
        const Real len = length(w), across = std::sqrt(w.x * w.x + w.y * w.y);
        const Real cosine = w.z / len, sine = across / len;
        const Real s = lune_area(w, len) / len;
        const Real half_chord = std::sqrt((1 - disk.y) * (1 + disk.y));
        const Real x = s * disk.x + (1 - s) * half_chord;
        // half_chord^2 - x^2, the first factor of which is s (half_chord - disk.x).
        const Real z = std::sqrt(std::max(Real{0}, s * (half_chord - disk.x) * (half_chord + x)));
        // (c) The lune turned to w (e3) and the macrosurface normal (toward e1).
        const Real c_x = across > 0 ? w.x / across : Real{1};
        const Real c_y = across > 0 ? w.y / across : Real{0};
        const Real radial = z * sine - x * cosine;
        // x sine + z cosine is (x^2 sine^2 - z^2 cosine^2) over the same difference as below; the
        // numerator, x^2 - (half_chord cosine)^2, has a factor of s (disk.x + half_chord).
        Real up = x * sine + z * cosine;
        if (const Real difference = x * sine - z * cosine; x < 0 || cosine < 0)
            up = difference == 0 ? Real{0}
                                 : std::max(Real{0}, s * (disk.x + half_chord) *
                                                         ((x - half_chord * cosine) / difference));
        // (d) Back to the ellipsoid, and its normal there.
        return from_sphere({radial * c_x + disk.y * c_y, radial * c_y - disk.y * c_x, up});
    }

private:
    struct UpperTriangle {
        Real xx, xy, yy;
    };
    struct Disk {
        Real x, y, radius;
    };

    /// The concentric map of the square to the disk (eq. 34-37).
    static Disk concentric(const Uniform<Real>& u) {
        const Real a = 2 * u.x - 1, b = 2 * u.y - 1;
        if (a == 0 && b == 0) return {0, 0, 0};
        constexpr Real quarter = std::numbers::pi_v<Real> / 4;
        if (std::abs(a) > std::abs(b)) {
            const Real phi = quarter * (b / a);
            return {a * std::cos(phi), a * std::sin(phi), std::abs(a)};
        }
        const Real phi = quarter * (a / b);
        return {b * std::sin(phi), b * std::cos(phi), std::abs(b)};
    }

    Direction<Real> to_sphere(const Direction<Real>& v) const {
        return {k_.xx * v.x + k_.xy * v.y, k_.yy * v.y, v.z - (mean_.x * v.x + mean_.y * v.y)};
    }
    /// The unit normal A^T p, p on the unit sphere.
    Direction<Real> from_sphere(const Direction<Real>& p) const {
        return normalized(Direction<Real>{k_.xx * p.x - mean_.x * p.z,
                                          k_.xy * p.x + k_.yy * p.y - mean_.y * p.z, p.z});
    }
    /// (len + w_z) / 2, len = |w|, also where they nearly cancel.
    static Real lune_area(const Direction<Real>& w, Real len) {
        return w.z > 0 ? (len + w.z) / 2 : (w.x * w.x + w.y * w.y) / (2 * (len - w.z));
    }

    Ellipsoid ellipsoid_;
    UpperTriangle k_;
    Slope<Real> mean_;
    Real shear_, scale_;
};

/// `base` under M: the ellipsoid of A M^-1. Throws as Ellipsoid::transformed.
template <std::floating_point Real>
EllipsoidNDF<Real> transformed(const EllipsoidNDF<Real>& base, const Matrix2& m) {
    return EllipsoidNDF<Real>(base.ellipsoid().transformed(m));
}

extern template LTMD_API AnyDistribution<float>::AnyDistribution(EllipsoidNDF<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(EllipsoidNDF<double>);

}  // namespace ltmd::inline v0
