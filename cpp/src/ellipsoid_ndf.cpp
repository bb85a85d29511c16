// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ellipsoid_ndf.h"

#include "ltmd/errors.h"
#include "ltmd/require_range.h"
#include "text.h"

namespace ltmd::inline v0 {
namespace {

using Matrix = Ellipsoid::Matrix;
using Vector = Direction<double>;

constexpr double largest_condition = 1e7, smallest_norm = 1e-30, largest_norm = 1e30;

Vector operator*(const Matrix& a, const Vector& v) {
    return {a[0] * v.x + a[1] * v.y + a[2] * v.z, a[3] * v.x + a[4] * v.y + a[5] * v.z,
            a[6] * v.x + a[7] * v.y + a[8] * v.z};
}

Matrix operator*(const Matrix& a, const Matrix& b) {
    Matrix product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) product[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return product;
}

Vector column(const Matrix& a, std::size_t i) { return {a[i], a[3 + i], a[6 + i]}; }

Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vector scaled(const Vector& a, double by) { return {by * a.x, by * a.y, by * a.z}; }

double determinant(const Matrix& a) { return dot(cross(column(a, 0), column(a, 1)), column(a, 2)); }

double norm(const Matrix& a) {
    double sum = 0;
    for (const double entry : a) sum += entry * entry;
    return std::sqrt(sum);
}

/// |A|^-T u = the cofactors of A times u; its rows are the cross products of A's columns.
Vector cofactors(const Matrix& a, const Vector& u) {
    const Vector x = cross(column(a, 1), column(a, 2)), y = cross(column(a, 2), column(a, 0)),
                 z = cross(column(a, 0), column(a, 1));
    return {x.x * u.x + y.x * u.y + z.x * u.z, x.y * u.x + y.y * u.y + z.y * u.z,
            x.z * u.x + y.z * u.y + z.z * u.z};
}

std::string numbers(const Matrix& a) {
    return text("((", a[0], ", ", a[1], ", ", a[2], "), (", a[3], ", ", a[4], ", ", a[5], "), (",
                a[6], ", ", a[7], ", ", a[8], "))");
}

}  // namespace

Ellipsoid::Ellipsoid(const Matrix& a) : a_(a) {
    const double size = norm(a);
    if (!(size >= smallest_norm && size <= largest_norm))
        throw InvalidInput(text("A is ", numbers(a), "; its norm must be in [", smallest_norm, ", ",
                                largest_norm, "]"));
    const Vector x = scaled(column(a, 0), 1 / size), y = scaled(column(a, 1), 1 / size),
                 z = scaled(column(a, 2), 1 / size);
    // At norm 1 the condition is the norm of the cofactors over the determinant.
    const Vector yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
    const double condition =
        std::sqrt(dot(yz, yz) + dot(zx, zx) + dot(xy, xy)) / std::abs(dot(xy, z));
    if (!(condition <= largest_condition))
        throw InvalidInput(text("A is ", numbers(a), " with condition ", condition,
                                "; it must be invertible, with a condition of at most ",
                                largest_condition));
    // Q turns A n to (0, 0, |A n|); what the other columns have beside it are K's columns.
    const double along = dot(z, z), root = std::sqrt(along);
    mean_slope_ = {-dot(x, z) / along, -dot(y, z) / along};
    const auto beside = [&](const Vector& c, double slope) {
        return scaled({c.x + slope * z.x, c.y + slope * z.y, c.z + slope * z.z}, 1 / root);
    };
    const Vector kx = beside(x, mean_slope_.x), ky = beside(y, mean_slope_.y);
    const double first = length(kx);
    slope_matrix_ = {first, dot(kx, ky) / first, 0, length(cross(kx, ky)) / first};
}

Ellipsoid Ellipsoid::from_angles(double alpha_x, double alpha_y, double theta_x, double theta_y,
                                 double theta_z) {
    require_range("alpha_x", alpha_x, smallest_alpha, largest_alpha);
    require_range("alpha_y", alpha_y, smallest_alpha, largest_alpha);
    if (!(std::isfinite(theta_x) && std::isfinite(theta_y) && std::isfinite(theta_z)))
        throw InvalidInput(
            text("theta is (", theta_x, ", ", theta_y, ", ", theta_z, "); all must be finite"));
    const double cx = std::cos(theta_x), sx = std::sin(theta_x);
    const double cy = std::cos(theta_y), sy = std::sin(theta_y);
    const double cz = std::cos(theta_z), sz = std::sin(theta_z);
    return Ellipsoid(
        Matrix{alpha_x, 0, 0, 0, alpha_y, 0, 0, 0, 1} *
        (Matrix{1, 0, 0, 0, cx, -sx, 0, sx, cx} *
         (Matrix{cy, 0, sy, 0, 1, 0, -sy, 0, cy} * Matrix{cz, -sz, 0, sz, cz, 0, 0, 0, 1})));
}

Ellipsoid Ellipsoid::from_sggx(const Matrix& s) {
    const auto refuse = [&](const char* what) {
        throw InvalidInput(text("S is ", numbers(s), "; it must be ", what));
    };
    const double rounding = 1e-12 * norm(s);
    if (!(std::abs(s[1] - s[3]) <= rounding && std::abs(s[2] - s[6]) <= rounding &&
          std::abs(s[5] - s[7]) <= rounding))
        refuse("symmetric");
    // Cholesky's factors.
    const double xx = std::sqrt(s[0]), xy = s[1] / xx, xz = s[2] / xx;
    const double yy = std::sqrt(s[4] - xy * xy), yz = (s[5] - xy * xz) / yy;
    const double zz = std::sqrt(s[8] - xz * xz - yz * yz);
    if (!(xx > 0 && yy > 0 && zz > 0)) refuse("positive definite");
    return Ellipsoid(Matrix{xx, xy, xz, 0, yy, yz, 0, 0, zz});
}

Ellipsoid::Matrix Ellipsoid::sggx_matrix() const {
    Matrix s{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) s[3 * i + j] = dot(column(a_, i), column(a_, j));
    return s;
}

double Ellipsoid::gaussian_curvature(const Direction<double>& m, double c_e) const {
    const Vector u = scaled(cofactors(a_, m), 1 / determinant(a_));
    const double product = determinant(a_) * dot(u, u) / c_e;
    return product * product;
}

double Ellipsoid::projected_area(const Direction<double>& u, double c_e) const {
    return std::numbers::pi * c_e * c_e * length(a_ * u) / std::abs(determinant(a_));
}

double Ellipsoid::lune_area(const Direction<double>& u, const Direction<double>& v,
                            double c_e) const {
    const Vector au = a_ * u, av = a_ * v;
    return std::numbers::pi * c_e * c_e * (length(au) * length(av) + dot(au, av)) /
           (2 * std::abs(determinant(a_)) * length(av));
}

double Ellipsoid::unit_size() const { return 1 / std::sqrt(projected_area({0, 0, 1})); }

Direction<double> Ellipsoid::mean_normal() const { return normal_of(mean_slope_); }

Ellipsoid Ellipsoid::transformed(const Matrix2& m) const {
    require_invertible(m, "M");
    const Matrix2 i = inverse(m);
    return Ellipsoid(a_ * Matrix{i.xx, i.xy, 0, i.yx, i.yy, 0, 0, 0, 1});
}

Ellipsoid Ellipsoid::sheared(const Slope<double>& offset) const {
    return Ellipsoid(a_ * Matrix{1, 0, 0, 0, 1, 0, -offset.x, -offset.y, 1});
}

template AnyDistribution<float>::AnyDistribution(EllipsoidNDF<float>);
template AnyDistribution<double>::AnyDistribution(EllipsoidNDF<double>);

}  // namespace ltmd::inline v0
