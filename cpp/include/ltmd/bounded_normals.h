// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "ltmd/lobe_normals.h"
#include "ltmd/matrix2.h"

/// Bounded visible normals: for reflection, each GGX lobe's visible normals but for a spherical cap
/// of them that reflects the view below the horizon (Eto and Tokuyoshi 2023). In a mixture lobe i
/// is picked with a probability proportional to its weight times k_i v_z + t_i, t_i the length of
/// the stretched view; as the cap that is left covers every reflected direction l above the
/// horizon, their density is D / (2 K), K = sum of w_i (k_i v_z + t_i), whatever the lobes.
namespace ltmd::inline v0 {

/// The principal frame of a linear map M of the surface: an isotropic lobe of slope scale alpha has
/// the scales alpha x and alpha y along axes that are turned by an angle.
template <std::floating_point Real>
struct LobeFrame {
    Real x = 1, y = 1, cosine = 1, sine = 0;

    Direction<Real> into(const Direction<Real>& v) const {
        return {cosine * v.x + sine * v.y, cosine * v.y - sine * v.x, v.z};
    }
    Direction<Real> out_of(const Direction<Real>& v) const {
        return {cosine * v.x - sine * v.y, cosine * v.y + sine * v.x, v.z};
    }
    Direction<Real> stretched(Real alpha, const Direction<Real>& v) const {
        return {alpha * x * v.x, alpha * y * v.y, v.z};
    }
};

/// Throws InvalidInput unless M is finite and invertible.
template <std::floating_point Real>
LobeFrame<Real> lobe_frame(const Matrix2& m) {
    require_invertible(m, "M");
    // The eigenvectors of M M^T; the squared scales are 1 / its eigenvalues.
    const double a = m.xx * m.xx + m.xy * m.xy, b = m.xx * m.yx + m.xy * m.yy;
    const double d = m.yx * m.yx + m.yy * m.yy;
    const double angle = std::atan2(2 * b, a - d) / 2;
    const double large = (a + d + std::hypot(a - d, 2 * b)) / 2;
    const double longest = std::sqrt(large), det = std::abs(determinant(m));
    return {static_cast<Real>(1 / longest), static_cast<Real>(longest / det),
            static_cast<Real>(std::cos(angle)), static_cast<Real>(std::sin(angle))};
}

/// A mixture of isotropic GGX lobes under a linear map, seen from a unit vector above the surface.
template <std::floating_point Real>
class BoundedNormals {
public:
    static constexpr std::size_t capacity = 64;

    /// Of at most 64 lobes, slope scales and weights, that outlive this object.
    BoundedNormals(std::span<const Real> alpha, std::span<const Real> weight,
                   const Direction<Real>& v, const LobeFrame<Real>& frame = {})
        : alpha_(alpha), weight_(weight), frame_(frame), v_(frame.into(v)) {
        const Real s = 1 + std::sqrt(v.x * v.x + v.y * v.y), s2 = s * s;
        const Real across = square(frame.x * v_.x) + square(frame.y * v_.y);
        const Real least = std::min(frame.x, frame.y);
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            const Real a = std::min(Real{1}, alpha[i] * least), a2 = a * a;
            const Real k = (1 - a2) * s2 / (s2 + a2 * v.z * v.z);
            part_[i] = weight[i] * (k * v.z + std::sqrt(alpha[i] * alpha[i] * across + v.z * v.z));
        }
        for (std::size_t i = 0; i < alpha.size(); ++i) total_ += part_[i];
    }

    /// K.
    Real total() const { return total_; }

    Direction<Real> sample(const Uniform<Real>& u) const {
        Real rest = u.x * total_;
        std::size_t i = 0;
        while (i + 1 < alpha_.size() && rest >= part_[i]) rest -= part_[i++];
        while (i > 0 && !(part_[i] > 0)) rest = part_[--i];
        const Real share = std::min(rest / part_[i], Real{1});
        const Direction<Real> stretched = frame_.stretched(alpha_[i], v_);
        const Direction<Real> w = normalized(stretched);
        const Direction<Real> c = sample_cap(lowest(i, w.z), {share, u.y});
        const Direction<Real> h{c.x + w.x, c.y + w.y, std::max(Real{0}, c.z + w.z)};
        return normalized(frame_.out_of(frame_.stretched(alpha_[i], h)));
    }

    /// The density of sample(), per steradian, where D(m) is the mixture's.
    Real pdf(const Direction<Real>& m, Real D) const {
        const Direction<Real> n = frame_.into(m);
        const Real facing = dot(v_, n);
        if (!(facing > 0 && m.z > 0)) return 0;
        if (2 * facing * m.z > v_.z) return 2 * facing * D / total_;
        // Below the horizon each cap ends elsewhere.
        Real sum = 0;
        for (std::size_t i = 0; i < alpha_.size(); ++i) {
            const Real x = n.x / (alpha_[i] * frame_.x), y = n.y / (alpha_[i] * frame_.y);
            const Real length2 = x * x + y * y + n.z * n.z;
            const Direction<Real> w = normalized(frame_.stretched(alpha_[i], v_));
            // The point of the cap: w reflected at (x, y, n_z) / length.
            const Real z = 2 * (w.x * x + w.y * y + w.z * n.z) * n.z / length2 - w.z;
            if (z < lowest(i, w.z)) continue;
            sum += weight_[i] / (alpha_[i] * alpha_[i] * length2 * length2);
        }
        return 2 * facing * sum * std::numbers::inv_pi_v<Real> / (frame_.x * frame_.y * total_);
    }

private:
    static Real square(Real x) { return x * x; }
    /// The lowest z of lobe i's cap.
    Real lowest(std::size_t i, Real w_z) const {
        const Real s = 1 + std::sqrt(v_.x * v_.x + v_.y * v_.y), s2 = s * s;
        const Real a = std::min(Real{1}, alpha_[i] * std::min(frame_.x, frame_.y)), a2 = a * a;
        return -(1 - a2) * s2 / (s2 + a2 * v_.z * v_.z) * w_z;
    }

    std::span<const Real> alpha_, weight_;
    LobeFrame<Real> frame_;
    Direction<Real> v_;
    std::array<Real, capacity> part_{};
    Real total_ = 0;
};

}  // namespace ltmd::inline v0
