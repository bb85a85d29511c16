// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "ltmd/export.h"
#include "ltmd/matrix2.h"
#include "ltmd/mesh_view.h"
#include "ltmd/tension.h"

/// A microfacet lobe on a deformed surface: where geometry and distribution meet.
///
/// A map p' = M p of the surface with heights kept turns slopes by M^-T. The alpha^2 matrix Sigma
/// of a GGX or Beckmann lobe (P22 is a function of s^T Sigma^-1 s; diag(alpha_x^2, alpha_y^2) at
/// rest) becomes Sigma' = h^2 M^-T Sigma M^-1, with M = T_s M0: M0 is the material's own anisotropy
/// at rest, applied first, T_s the tension at a strength s, and h = det(T_s)^-height_response the
/// scale of heights (microsurface-transformations, eq. 9, 29-31 and section 4.1). Results are in
/// the frame of the deformed surface, x along dP'/du; what exceeds the range of float saturates.
namespace ltmd::inline v0 {

/// A lobe at rest and how it follows tension.
struct Lobe {
    double alpha_x = 0.5, alpha_y = 0.5;  ///< Slope scales at rest along U and V, above 0.
    Matrix2 m0 = {};                      ///< The material's own anisotropy, invertible.
    double strength = 1;  ///< s >= 0: T = V Rot(phi), T_s = V^s Rot(s phi). 0 is no deformation.
    double height_response = 0;  ///< 0: heights are kept (the paper), 1: volume is kept.
};

/// Throws InvalidInput for an alpha of 0 or less, an m0 that is not invertible (condition above
/// 1e6), a strength below 0, or any of them not finite.
LTMD_API void validate(const Lobe& lobe);

/// The pass `alpha2`: (sigma_xx, sigma_xy, sigma_yy) of Sigma' for each tension; filters linearly.
/// Throws InvalidInput for a lobe that validate() refuses, a tension that is not finite with a
/// positive diagonal (the first is named), or another length of `out`.
LTMD_API void alpha2(std::span<const Tension> t, const Lobe& lobe, std::span<Vec3f> out);

/// (alpha_x, alpha_y, angle): alpha_x <= alpha_y, angle in [0, pi) from x to the direction of
/// alpha_x, counter-clockwise; 0 where both are equal. Alphas are not clamped: a squeeze can bring
/// them past 1. Throws as alpha2().
LTMD_API void lobe_parameters(std::span<const Tension> t, const Lobe& lobe, std::span<Vec3f> out);

/// The pass `roughness`: (alpha_x, alpha_y, cos 2 angle, sin 2 angle) of lobe_parameters(), without
/// the jump of the angle at pi. Throws as alpha2().
LTMD_API void roughness(std::span<const Tension> t, const Lobe& lobe,
                        std::span<std::array<float, 4>> out);

}  // namespace ltmd::inline v0
