// SPDX-License-Identifier: Apache-2.0
// This work is based on: microsurface-transformations, section 5.1.
#include "ltmd/tangent_frame.h"

#include "vector_math.h"

namespace ltmd::inline v0 {
namespace {

Vec3d to_array(const V3d& v) { return {v.x, v.y, v.z}; }

}  // namespace

int uv_area_sign(const Vec2f& uv0, const Vec2f& uv1, const Vec2f& uv2) {
    // Differences and products of floats are exact in double, so the comparison is too.
    const double left =
        (static_cast<double>(uv1[0]) - uv0[0]) * (static_cast<double>(uv2[1]) - uv0[1]);
    const double right =
        (static_cast<double>(uv2[0]) - uv0[0]) * (static_cast<double>(uv1[1]) - uv0[1]);
    return (left > right) - (left < right);
}

bool tangent_frame(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2, const Vec2f& uv0,
                   const Vec2f& uv1, const Vec2f& uv2, TangentFrame& frame) {
    const V3d e1 = to_double(p1) - to_double(p0), e2 = to_double(p2) - to_double(p0);
    const V3d cross = e1.cross(e2);
    const int sign = uv_area_sign(uv0, uv1, uv2);
    if (sign == 0 || has_no_area(e1, e2, cross)) return false;
    const double dv1 = static_cast<double>(uv1[1]) - uv0[1],
                 dv2 = static_cast<double>(uv2[1]) - uv0[1];
    const V3d x = ((e1 * dv2 - e2 * dv1) * sign).normalized();
    const V3d z = cross.normalized();
    frame = {to_array(x), to_array(z.cross(x)), to_array(z)};
    return true;
}

}  // namespace ltmd::inline v0
