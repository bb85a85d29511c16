// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "ltmd/export.h"

/// Linear maps p' = M p of the tangent plane (microsurface-transformations, eq. 9).
namespace ltmd::inline v0 {

/// Row-major [[xx, xy], [yx, yy]]: a of eq. 9 is xx, b is yx, c is xy, d is yy.
struct Matrix2 {
    double xx = 1, xy = 0, yx = 0, yy = 1;

    bool operator==(const Matrix2&) const = default;
};

inline Matrix2 operator*(const Matrix2& a, const Matrix2& b) {
    return {a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx,
            a.yx * b.xy + a.yy * b.yy};
}

inline double determinant(const Matrix2& m) { return m.xx * m.yy - m.xy * m.yx; }

/// The inverse of an invertible matrix.
inline Matrix2 inverse(const Matrix2& m) {
    const double d = determinant(m);
    return {m.yy / d, -m.xy / d, -m.yx / d, m.xx / d};
}

/// The rotation by `angle` radians, counter-clockwise.
LTMD_API Matrix2 rotation_matrix(double angle);

/// The stretch anisotropy M_s = diag(1/(1-s), 1-s), or diag(1+s, 1/(1+s)) for s < 0
/// (microsurface-transformations, eq. 31). Throws InvalidInput unless -1 < s < 1.
LTMD_API Matrix2 stretch_matrix(double s);

/// The symmetric positive definite M under which an isotropic distribution of slope scale 1 gets
/// scales alpha_x and alpha_y with correlation r_xy: M = Q^(1/2), Q^-1 = [[alpha_x^2, r_xy alpha_x
/// alpha_y], [., alpha_y^2]] (masking-shadowing, eq. 88). Throws InvalidInput unless the alphas are
/// in [1e-6, 1e6] and -1 < r_xy < 1.
LTMD_API Matrix2 correlated_stretch(double alpha_x, double alpha_y, double r_xy);

/// The material's anisotropy M0 = Rot(rotation) [[1, shear], [0, 1]] M_stretch, rotation in radians
/// counter-clockwise from U. Throws InvalidInput unless -1 < stretch < 1 and all are finite.
LTMD_API Matrix2 material_matrix(double stretch, double rotation, double shear);

/// Throws InvalidInput, naming `name` and its numbers, unless m is finite and invertible (condition
/// at most 1e6).
LTMD_API void require_invertible(const Matrix2& m, const char* name);

/// The 2x2 part of a row-major 3x3 matrix of eq. 9. Throws InvalidInput unless its third row and
/// column are (0, 0, 1): only maps of the tangent plane keep a microsurface valid. Scale M's 2x2
/// part by 1/h to scale heights by h; for vertical shear see non_centred_distribution.h.
LTMD_API Matrix2 tangent_plane_part(const std::array<double, 9>& m);

}  // namespace ltmd::inline v0
