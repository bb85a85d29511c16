// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <concepts>

/// Directions and slopes in the tangent frame: x along U, z the macrosurface normal.
namespace ltmd::inline v0 {

/// A vector of the tangent frame; a unit vector unless a function says otherwise.
template <std::floating_point Real>
struct Direction {
    Real x, y, z;
};

/// The slopes (-m_x/m_z, -m_y/m_z) of a microfacet with normal m.
template <std::floating_point Real>
struct Slope {
    Real x, y;
};

/// Two random numbers, uniform in [0, 1].
template <std::floating_point Real>
struct Uniform {
    Real x, y;
};

template <std::floating_point Real>
Real dot(const Direction<Real>& a, const Direction<Real>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <std::floating_point Real>
Real length(const Direction<Real>& a) {
    return std::sqrt(dot(a, a));
}

/// `a` at length 1; not a number where its length is 0.
template <std::floating_point Real>
Direction<Real> normalized(const Direction<Real>& a) {
    const Real scale = 1 / length(a);
    return {a.x * scale, a.y * scale, a.z * scale};
}

/// The slopes of a normal, infinite where m_z is 0 (microsurface-transformations, eq. 4).
template <std::floating_point Real>
Slope<Real> slope_of(const Direction<Real>& m) {
    return {-m.x / m.z, -m.y / m.z};
}

/// The unit normal of finite slopes.
template <std::floating_point Real>
Direction<Real> normal_of(const Slope<Real>& slope) {
    return normalized(Direction<Real>{-slope.x, -slope.y, 1});
}

}  // namespace ltmd::inline v0
