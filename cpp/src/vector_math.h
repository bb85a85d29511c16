// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImathVec.h>

#include <algorithm>
#include <cmath>

#include "ltmd/mesh_view.h"

namespace ltmd::inline v0 {

using Imath::V3d;

inline V3d to_double(const Vec3f& p) { return V3d(p[0], p[1], p[2]); }

/// |e1 x e2| <= 1e-7 max edge^2: the triangle has no usable area.
inline bool has_no_area(const V3d& e1, const V3d& e2, const V3d& cross) {
    const double longest = std::max({e1.length2(), e2.length2(), (e2 - e1).length2()});
    return !(cross.length() > 1e-7 * longest);
}

inline constexpr double min_stretch = 1e-3;
inline constexpr double max_stretch = 1e3;

/// A symmetric positive 2x2 matrix and the root of its determinant.
struct Gram {
    double c11, c12, c22, root_det;
};

/// Whether both singular values are in the stretch range, from the trace and determinant of their
/// squares: sufficient, and true of nearly every face.
inline bool is_in_stretch_range(double trace, double det) {
    return (trace <= max_stretch * max_stretch) & (det >= min_stretch * min_stretch * trace) &
           (det > 0);
}

/// Clamps the eigenvalues of a Gram matrix to the squares of the stretch range.
inline Gram clamp_stretch(Gram c) {
    const double trace = c.c11 + c.c22;
    const double det = c.root_det * c.root_det;
    if (is_in_stretch_range(trace, det)) return c;
    const double difference = std::hypot(c.c11 - c.c22, 2 * c.c12);
    const double largest = 0.5 * (trace + difference);
    const double smallest = largest > 0 ? det / largest : 0;
    const double s1 = std::clamp(std::sqrt(largest), min_stretch, max_stretch);
    const double s2 = std::clamp(std::sqrt(smallest), min_stretch, max_stretch);
    const double angle = 0.5 * std::atan2(2 * c.c12, c.c11 - c.c22);
    const double cosine = std::cos(angle), sine = std::sin(angle);
    const double l1 = s1 * s1, l2 = s2 * s2;
    return {l1 * cosine * cosine + l2 * sine * sine, (l1 - l2) * cosine * sine,
            l1 * sine * sine + l2 * cosine * cosine, s1 * s2};
}

}  // namespace ltmd::inline v0
