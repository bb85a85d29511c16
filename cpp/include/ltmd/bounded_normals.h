// SPDX-License-Identifier: Apache-2.0
#pragma once

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

    /// Of `count` lobes, slope scales and weights, that outlive this object: at most 64, divisible
    /// by 4.
    BoundedNormals(const Real* alpha, const Real* weight, std::size_t count,
                   const Direction<Real>& v, const LobeFrame<Real>& frame = {})
        : alpha_(alpha),
          weight_(weight),
          count_(count),
          frame_(frame),
          v_(frame.into(v)),
          reach2_(square(1 + std::sqrt(v.x * v.x + v.y * v.y))),
          least2_(square(std::min(frame.x, frame.y))),
          share_(count, [&, across = square(frame.x * v_.x) + square(frame.y * v_.y),
                         z = v.z](std::size_t i) {
              const Real a2 = alpha[i] * alpha[i];
              return weight[i] * (cap(a2) * z + std::sqrt(a2 * across + z * z));
          }) {}

    /// K.
    Real total() const { return share_.total(); }

    Direction<Real> sample(const Uniform<Real>& u) const {
        const auto [i, place] = share_.pick(u.x);
        const Direction<Real> w = normalized(frame_.stretched(alpha_[i], v_));
        const Direction<Real> c = sample_cap(lowest(i, w.z), {place, u.y});
        const Direction<Real> h{c.x + w.x, c.y + w.y, std::max(Real{0}, c.z + w.z)};
        return normalized(frame_.out_of(frame_.stretched(alpha_[i], h)));
    }

    /// The density of sample(), per steradian, where D(m) is the mixture's.
    Real pdf(const Direction<Real>& m, Real D) const {
        const Direction<Real> n = frame_.into(m);
        const Real facing = dot(v_, n);
        if (!(facing > 0 && m.z > 0)) return 0;
        if (2 * facing * m.z > v_.z) return 2 * facing * D / total();
        // Below the horizon each cap ends elsewhere.
        Real sum = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const Real x = n.x / (alpha_[i] * frame_.x), y = n.y / (alpha_[i] * frame_.y);
            const Real length2 = x * x + y * y + n.z * n.z;
            const Direction<Real> w = normalized(frame_.stretched(alpha_[i], v_));
            // The point of the cap: w reflected at (x, y, n_z) / length.
            const Real z = 2 * (w.x * x + w.y * y + w.z * n.z) * n.z / length2 - w.z;
            if (z < lowest(i, w.z) || weight_[i] == 0) continue;
            sum += weight_[i] / (alpha_[i] * alpha_[i] * length2 * length2);
        }
        return 2 * facing * sum * std::numbers::inv_pi_v<Real> / (frame_.x * frame_.y * total());
    }

private:
    static Real square(Real x) { return x * x; }
    /// k of a lobe of alpha^2.
    Real cap(Real alpha2) const {
        const Real a2 = elementary::min(Real{1}, alpha2 * least2_);
        return (1 - a2) * reach2_ / (reach2_ + a2 * v_.z * v_.z);
    }
    /// The lowest z of lobe i's cap.
    Real lowest(std::size_t i, Real w_z) const { return -cap(alpha_[i] * alpha_[i]) * w_z; }

    const Real *alpha_, *weight_;
    std::size_t count_;
    LobeFrame<Real> frame_;
    Direction<Real> v_;
    Real reach2_, least2_;
    LobeShares<Real, capacity> share_;
};

}  // namespace ltmd::inline v0
