// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "ltmd/any_distribution.h"
#include "ltmd/beckmann.h"
#include "ltmd/bounded_normals.h"
#include "ltmd/errors.h"
#include "ltmd/export.h"
#include "ltmd/ggx.h"

namespace ltmd::inline v0 {

enum class LobeKind { ggx, beckmann };

/// An isotropic lobe of a mixture.
struct MixtureLobe {
    LobeKind kind;
    double alpha, weight;

    bool operator==(const MixtureLobe&) const = default;
};

/// The lobes with the GGX lobes first and weights that add up to 1. Throws InvalidInput unless
/// there are 1 to 64, with alpha in [1e-6, 1e6] and weights that are finite, at least 0 and not all
/// 0.
LTMD_API std::vector<MixtureLobe> normalized_lobes(std::span<const MixtureLobe> lobes);

/// A mixture of isotropic GGX and Beckmann lobes: P22, Lambda and projected areas add up, and
/// visible normals are those of a lobe that is picked by its projected area.
template <std::floating_point R>
class LobeMixture : public SlopeDistribution<LobeMixture<R>, R> {
public:
    using Real = R;
    static constexpr std::size_t capacity = BoundedNormals<R>::capacity;

    /// Weights may have any sum; throws as normalized_lobes().
    explicit LobeMixture(std::span<const MixtureLobe> lobes) {
        for (const MixtureLobe& lobe : normalized_lobes(lobes)) {
            alpha_[count_] = static_cast<Real>(lobe.alpha);
            weight_[count_++] = static_cast<Real>(lobe.weight);
            ggx_count_ += lobe.kind == LobeKind::ggx;
        }
        padded_count_ = (count_ + Shares::lanes - 1) / Shares::lanes * Shares::lanes;
    }

    /// Number of lobes, and of those that are GGX: these come first.
    std::size_t size() const { return count_; }
    std::size_t ggx_size() const { return ggx_count_; }
    std::span<const Real> alpha() const { return {alpha_.data(), count_}; }
    std::span<const Real> weight() const { return {weight_.data(), count_}; }

    Real P22(const Slope<Real>& slope) const {
        return density(slope.x * slope.x + slope.y * slope.y, Real{1});
    }

    Real D(const Direction<Real>& m) const {
        return m.z > 0 ? density(m.x * m.x + m.y * m.y, m.z * m.z) : Real{0};
    }

    Real Lambda(const Direction<Real>& v) const {
        const Real z = v.z, across2 = v.x * v.x + v.y * v.y;
        Real ggx = 0, beckmann = 0;
        for (std::size_t i = 0; i < ggx_count_; ++i) {
            const Real b = alpha_[i] * alpha_[i] * across2;
            ggx += weight_[i] * b / (2 * (z + std::sqrt(z * z + b)));
        }
        for (std::size_t i = ggx_count_; i < count_; ++i)
            beckmann += weight_[i] * beckmann_.Lambda(stretched(i, v));
        return ggx / z + beckmann;
    }

    Real projected_area(const Direction<Real>& v) const { return areas(v).total(); }

    Direction<Real> sample(const Uniform<Real>& u) const {
        const auto [i, place] =
            Shares(padded_count_, [&](std::size_t lobe) { return weight_[lobe]; }).pick(u.y);
        const Uniform<Real> inside{u.x, place};
        return from_unit(i, i < ggx_count_ ? ggx_.sample(inside) : beckmann_.sample(inside));
    }

    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        const auto [i, place] = areas(v).pick(u.x);
        const Direction<Real> w = normalized(stretched(i, v));
        if (i >= ggx_count_) return from_unit(i, beckmann_.sample_visible(w, {place, u.y}));
        return from_unit(i, sample_visible_ggx(w, {place, u.y}));
    }

    /// Visible normals for reflection of a unit vector v (see bounded_normals.h), under M of a
    /// lobe_frame(M). Throws InvalidInput unless all lobes are GGX.
    Direction<Real> sample_bounded(const Direction<Real>& v, const Uniform<Real>& u,
                                   const LobeFrame<Real>& frame = {}) const {
        return bounded(v, frame).sample(u);
    }

    /// The density of sample_bounded(), per steradian of m; that of the reflected direction is
    /// this over 4 v.m.
    Real pdf_bounded(const Direction<Real>& v, const Direction<Real>& m,
                     const LobeFrame<Real>& frame = {}) const {
        const Direction<Real> n = frame.into(m);
        const Real x = n.x / frame.x, y = n.y / frame.y;
        const Real D = m.z > 0 ? density(x * x + y * y, m.z * m.z) / (frame.x * frame.y) : Real{0};
        return bounded(v, frame).pdf(m, D);
    }

    // The same for arrays, on thread_count() threads. Throws InvalidInput unless all have one
    // length.
    LTMD_API void sample_bounded(std::span<const Direction<Real>> v,
                                 std::span<const Uniform<Real>> u, const LobeFrame<Real>& frame,
                                 std::span<Direction<Real>> out) const;
    LTMD_API void pdf_bounded(std::span<const Direction<Real>> v,
                              std::span<const Direction<Real>> m, const LobeFrame<Real>& frame,
                              std::span<Real> out) const;

private:
    using Shares = LobeShares<Real, capacity>;

    BoundedNormals<Real> bounded(const Direction<Real>& v, const LobeFrame<Real>& frame) const {
        if (ggx_count_ < count_)
            throw InvalidInput("bounded visible normals are those of GGX lobes; " +
                               std::to_string(count_ - ggx_count_) + " lobes are Beckmann's");
        return {alpha_.data(), weight_.data(), padded_count_, v, frame};
    }

    /// P22 / z^4 at slopes of the square across2 / z2.
    Real density(Real across2, Real z2) const {
        Real ggx = 0, beckmann = 0;
        for (std::size_t i = 0; i < ggx_count_; ++i) {
            const Real a2 = alpha_[i] * alpha_[i], sum = z2 + across2 / a2;
            ggx += weight_[i] / (a2 * sum * sum);
        }
        // Below, exp() is 0.
        const Real floor = std::max(z2, std::sqrt(std::numeric_limits<Real>::min()) * 16);
        for (std::size_t i = ggx_count_; i < count_; ++i) {
            const Real a2 = alpha_[i] * alpha_[i];
            beckmann += weight_[i] / a2 * elementary::exp(-across2 / (a2 * floor));
        }
        return std::numbers::inv_pi_v<Real> * (ggx + beckmann / (floor * floor));
    }

    /// The lobes' projected areas.
    Shares areas(const Direction<Real>& v) const {
        const Real z = v.z, across2 = v.x * v.x + v.y * v.y;
        const auto ggx = [&](std::size_t i) {
            return weight_[i] * (z + std::sqrt(z * z + alpha_[i] * alpha_[i] * across2)) / 2;
        };
        if (ggx_count_ == count_) return Shares(padded_count_, ggx);
        return Shares(padded_count_, [&](std::size_t i) {
            if (i < ggx_count_) return ggx(i);
            return i < count_ ? weight_[i] * beckmann_.projected_area(stretched(i, v)) : Real{0};
        });
    }

    Direction<Real> stretched(std::size_t i, const Direction<Real>& v) const {
        return {alpha_[i] * v.x, alpha_[i] * v.y, v.z};
    }
    Direction<Real> from_unit(std::size_t i, const Direction<Real>& m) const {
        return normalized(stretched(i, m));
    }

    std::size_t count_ = 0, padded_count_ = 0, ggx_count_ = 0;
    std::array<Real, capacity> alpha_{}, weight_{};
    // Lobes are these, stretched.
    GGX<Real> ggx_{1};
    Beckmann<Real> beckmann_{1};
};

/// GTR for 0 <= gamma <= 2 as GGX lobes, by Gauss's rule in log(alpha): Feynman's parameters of
/// (1 + t)^(gamma-2) (t + alpha^2)^-gamma. With 8 to 16 lobes (alpha from 1 to 1e-4) Lambda is
/// within 1e-7, with 12 to 40 within 1e-12. Throws InvalidInput unless alpha is in [1e-4, 1] and
/// count in [1, 40].
LTMD_API std::vector<MixtureLobe> gtr_ggx_lobes(double alpha, double gamma, int count);

/// GTR for 0 < gamma <= 4 as Beckmann lobes, by Gauss's rule in the logarithm of their rate
/// t = 1 / alpha_i^2, whose weight is e^-t 1F1(gamma; 2; (1 - alpha^2) t). Beckmann lobes have no
/// tails: they meet GTR's with many lobes only. Throws InvalidInput unless alpha is in [1e-4, 1],
/// gamma in [1e-3, 4] and count in [1, 64].
LTMD_API std::vector<MixtureLobe> gtr_beckmann_lobes(double alpha, double gamma, int count);

/// GTR as few lobes.
struct FittedLobes {
    std::vector<MixtureLobe> lobes;
    /// Of P22, over the slopes where u P22 is at least 1e-3 of its peak, u = tan^2.
    double max_relative_error;
};

/// At most max_lobes lobes, of a table that is continuous in alpha and gamma: GGX for gamma <= 2,
/// beyond one GGX lobe and Beckmann lobes. Throws InvalidInput unless alpha is in [1e-4, 1], gamma
/// in [0, 4] and max_lobes in [1, 6].
LTMD_API FittedLobes fit_lobes(double alpha, double gamma, int max_lobes = 6);

extern template LTMD_API AnyDistribution<float>::AnyDistribution(LobeMixture<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(LobeMixture<double>);

}  // namespace ltmd::inline v0
