// SPDX-License-Identifier: Apache-2.0
#include "ltmd/matrix2.h"

#include <cmath>

#include "ltmd/errors.h"
#include "ltmd/require_range.h"
#include "text.h"

namespace ltmd::inline v0 {
namespace {

constexpr double largest_condition = 1e6;

}  // namespace

Matrix2 rotation_matrix(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c, -s, s, c};
}

Matrix2 stretch_matrix(double s) {
    if (!(s > -1 && s < 1))
        throw InvalidInput(text("stretch is ", s, "; it must be between -1 and 1"));
    const double along = s < 0 ? 1 + s : 1 / (1 - s);
    return {along, 0, 0, 1 / along};
}

Matrix2 correlated_stretch(double alpha_x, double alpha_y, double r_xy) {
    require_range("alpha_x", alpha_x, 1e-6, 1e6);
    require_range("alpha_y", alpha_y, 1e-6, 1e6);
    if (!(r_xy > -1 && r_xy < 1))
        throw InvalidInput(text("r_xy is ", r_xy, "; it must be between -1 and 1"));
    const double rest = (1 - r_xy) * (1 + r_xy);
    const double xx = 1 / (alpha_x * alpha_x * rest), yy = 1 / (alpha_y * alpha_y * rest);
    const double xy = -r_xy / (alpha_x * alpha_y * rest);
    // The root of a symmetric 2x2 matrix: (Q + |Q|^(1/2) I) / (tr Q + 2 |Q|^(1/2))^(1/2).
    const double root = 1 / (alpha_x * alpha_y * std::sqrt(rest));
    const double scale = 1 / std::sqrt(xx + yy + 2 * root);
    return {(xx + root) * scale, xy * scale, xy * scale, (yy + root) * scale};
}

Matrix2 material_matrix(double stretch, double rotation, double shear) {
    if (!std::isfinite(rotation) || !std::isfinite(shear))
        throw InvalidInput(
            text("rotation is ", rotation, ", shear ", shear, "; both must be finite"));
    return rotation_matrix(rotation) * (Matrix2{1, shear, 0, 1} * stretch_matrix(stretch));
}

void require_invertible(const Matrix2& m, const char* name) {
    const double size2 = m.xx * m.xx + m.xy * m.xy + m.yx * m.yx + m.yy * m.yy;
    const double det = std::abs(determinant(m));
    // |m|^2 / |det m| is within a factor of 2 of the condition number.
    if (!(std::isfinite(size2) && det > 0 && size2 / det <= largest_condition))
        throw InvalidInput(text(name, " is ((", m.xx, ", ", m.xy, "), (", m.yx, ", ", m.yy,
                                ")); it must be invertible"));
}

Matrix2 tangent_plane_part(const std::array<double, 9>& m) {
    if (!(m[2] == 0 && m[5] == 0 && m[6] == 0 && m[7] == 0 && m[8] == 1))
        throw InvalidInput(text("M has third column (", m[2], ", ", m[5], ", ", m[8],
                                ") and third row (", m[6], ", ", m[7], ", ", m[8],
                                "); both must be (0, 0, 1): only maps of the tangent plane keep a "
                                "microsurface valid"));
    return {m[0], m[1], m[3], m[4]};
}

}  // namespace ltmd::inline v0
