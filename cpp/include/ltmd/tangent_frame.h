// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "ltmd/export.h"
#include "ltmd/mesh_view.h"

/// The U-preserving tangent frame of a triangle (microsurface-transformations, section 5.1).
///
/// x = dP/du normalised, z = the geometric normal e1 x e2 normalised, y = z x x: right-handed, the
/// same rule in the rest and the deformed state. Mirrored UVs (negative UV area) change x only.
namespace ltmd::inline v0 {

using Vec3d = std::array<double, 3>;

/// Three orthonormal axes.
struct TangentFrame {
    Vec3d x, y, z;
};

/// The sign of a triangle's UV area: 1, -1 (mirrored) or 0 (no area). Exact for float UVs that lie
/// within 2^26 of each other.
LTMD_API int uv_area_sign(const Vec2f& uv0, const Vec2f& uv1, const Vec2f& uv2);

/// Writes the frame of triangle (p0, p1, p2) and returns true; returns false and leaves `frame`
/// alone for a degenerate triangle: |e1 x e2| <= 1e-7 times the square of the longest edge, or no
/// UV area.
LTMD_API bool tangent_frame(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2, const Vec2f& uv0,
                            const Vec2f& uv1, const Vec2f& uv2, TangentFrame& frame);

}  // namespace ltmd::inline v0
