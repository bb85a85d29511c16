// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "ltmd/export.h"
#include "ltmd/mesh_view.h"
#include "ltmd/rest_state.h"

/// The tension matrix T = D R^-1 of a deformation (microsurface-transformations, section 5.1 and
/// Fig. 7).
///
/// R = (r1 r2) and D = (d1 d2) hold a triangle's edges at rest and deformed, each in its own
/// U-preserving frame (tangent_frame.h). In these frames T = [[t11, t12], [0, t22]] with t11, t22 >
/// 0: t11 = |dP'/du| / |dP/du|, det T = area ratio. So three numbers are stored, and any average of
/// them is invertible.
///
/// Computed as E = [d1 d2] R^-1 (3x2, no deformed frame): t11 = |E_u|, t12 = E_u . E_v / t11, t22 =
/// |E_u x E_v| / t11. Degenerate: a rest triangle without area or UV area gives the identity (1, 0,
/// 1); the singular values of E are clamped to [1e-3, 1e3].
///
/// Space: positions of both states in the metric of the rendered object, so that object scale is
/// not counted as stretch.
namespace ltmd::inline v0 {

/// (t11, t12, t22), dimensionless.
using Tension = Vec3f;

inline constexpr Tension identity_tension = {1.0f, 0.0f, 1.0f};

/// Where tension is measured.
enum class Per {
    triangle,  ///< [T] each triangle's own.
    vertex,    ///< [V] mean over all faces of the vertex, weighted by rest area; mixes frames at UV
               ///< seams.
    corner,    ///< [C] mean over the corner's UV fan, weighted by rest area; never across seams or
               ///< mirrored UVs.
};

/// The number of tensions that `per` gives.
LTMD_API std::size_t tension_count(const RestState& rest, Per per);

/// Writes the tension of `deformed` ([V] positions) into `out` ([tension_count]). Corners and
/// vertices of no face get the identity. Throws InvalidInput for another vertex count, a non-finite
/// position (the first is named), a mesh without UV map, or a wrong size of `out`.
LTMD_API void tension(const RestState& rest, std::span<const Vec3f> deformed, Per per,
                      std::span<Tension> out);

/// The row-major 2x2 matrix of each tension: (t11, t12, 0, t22).
LTMD_API void tension_matrix(std::span<const Tension> t, std::span<std::array<float, 4>> out);

/// The pass `stretch`: (largest principal stretch, smallest, area ratio) of each tension. Needs no
/// frame: the same on both sides of a UV seam.
LTMD_API void stretch(std::span<const Tension> t, std::span<Vec3f> out);

}  // namespace ltmd::inline v0
