// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "ltmd/any_distribution.h"
#include "ltmd/bounded_normals.h"
#include "ltmd/errors.h"
#include "ltmd/export.h"
#include "ltmd/require_range.h"
#include "ltmd/slope_distribution.h"

namespace ltmd::inline v0 {

/// GTR(alpha, gamma) as a positive mixture of densities of the slope's square t,
/// (n - 1) B^(n-1) / pi (t + B)^-n with n = 2 (GGX lobes of alpha^2 = B), 3 and 4.
///
/// For gamma in (0, 2) Feynman's parameters give (1 + t)^(gamma-2) (t + alpha^2)^-gamma as the mean
/// of (t + B)^-2 over x of the distribution Beta(gamma, 2 - gamma), B = x alpha^2 + 1 - x. Beyond,
/// let g = gamma - 1 or gamma - 2 be in (1, 2]: with F_g the mean for g, and its derivatives by
/// alpha^2 of both factors,
///   F_{g+1} = F_g - (1 - alpha^2) / g F_g',
///   F_{g+2} = F_g - 2 (1 - alpha^2) / g F_g' + (1 - alpha^2)^2 / (g (g + 1)) F_g'',
/// and as -(t + B)^-2' = 2 (t + B)^-3 all weights stay positive. The rule is Gauss's in log B.
struct GTRLobes {
    static constexpr std::size_t capacity = 40;

    std::size_t count = 0;
    /// The greatest n of the mixture.
    int greatest_power = 2;
    std::array<double, capacity> B{};
    /// The weights of n = 2, 3, 4; all together are 1.
    std::array<std::array<double, capacity>, 3> weight{};
};

/// With at most `nodes` values of B, and no more than gtr_node_count() in double precision. Throws
/// InvalidInput unless 1e-4 <= alpha <= 1 and 0 <= gamma <= 4.
LTMD_API GTRLobes gtr_lobes(double alpha, double gamma, int nodes);

/// The nodes after which Lambda's relative error is below 1e-7 (single precision) or 1e-12.
LTMD_API int gtr_node_count(double alpha, double gamma, bool single_precision);

/// How GTR is masked.
enum class GTRMasking {
    /// Smith's masking of the distribution itself.
    exact,
    /// The published approximation: G1 of the integers gamma = 0 ... 4, between them the natural
    /// cubic spline (microsurface-transformations, appendix A). At small alpha it is far off
    /// between the integers; G1 is kept within [0, 1].
    spline
};

/// The weights of the values at 0 ... 4 in their natural cubic spline at gamma.
LTMD_API std::array<double, 5> natural_spline_weights(double gamma);

/// The Generalized Trowbridge-Reitz distribution (microsurface-transformations, eq. 32, 33):
/// gamma = 2 is GGX, less has longer tails.
///
/// alpha < 1e-4 is below what a float resolves of a unit normal's slopes.
template <std::floating_point R>
class GTR : public SlopeDistribution<GTR<R>, R> {
public:
    using Real = R;
    static constexpr bool normals_vectorize = true;

    /// Throws InvalidInput unless alpha is in [1e-4, 1] and gamma in [0, 4].
    GTR(double alpha, double gamma, GTRMasking masking = GTRMasking::exact)
        : alpha_(require_range("alpha", alpha, 1e-4, 1)),
          gamma_(require_range("gamma", gamma, 0, 4)),
          masking_(masking) {
        const double alpha2 = alpha * alpha, log_alpha2 = 2 * std::log(alpha);
        // (e^x - 1) / x.
        const auto phi = [](double x) { return x == 0 ? 1 : std::expm1(x) / x; };
        alpha2_ = static_cast<Real>(alpha2);
        inverse_alpha2_ = static_cast<Real>(1 / alpha2);
        sine2_ = static_cast<Real>((1 - alpha) * (1 + alpha));
        power_ = static_cast<Real>(gamma);
        // D(n) = C alpha^(-2 gamma) with C of eq. 32, (1 - alpha^2) / (-log(alpha^2)) =
        // phi(log(alpha^2)).
        const double y = (1 - gamma) * log_alpha2;
        peak_ = static_cast<Real>(std::numbers::inv_pi * phi(log_alpha2) / phi(y) /
                                  std::pow(alpha2, gamma));
        log_range_ = static_cast<Real>(-log_alpha2);
        // Random numbers are no nearer to 1 than that.
        sample_scale_ = std::max(static_cast<Real>(std::expm1(-y)),
                                 std::numeric_limits<Real>::epsilon() / 2 - 1);
        const auto sample_power = static_cast<Real>(gamma - 1);
        sample_factor_ = sample_power == 0 ? Real{0} : 1 / sample_power;
        sample_linear_ = sample_power == 0 ? log_range_ : Real{0};
        sample_ratio_ = sine2_ > 0 ? alpha2_ / sine2_ : Real{0};
        sample_flat_ = sine2_ > 0 ? Real{0} : Real{1};

        const GTRLobes lobes =
            gtr_lobes(alpha, gamma, gtr_node_count(alpha, gamma, sizeof(Real) < sizeof(double)));
        greatest_power_ = lobes.greatest_power;
        count_ = (lobes.count + lanes - 1) / lanes * lanes;
        B_.fill(1);
        lobe_alpha_.fill(1);
        for (std::size_t i = 0; i < lobes.count; ++i) {
            B_[i] = static_cast<Real>(lobes.B[i]);
            lobe_alpha_[i] = static_cast<Real>(std::sqrt(lobes.B[i]));
            for (std::size_t n = 0; n < 3; ++n)
                weight_[n][i] = static_cast<Real>(lobes.weight[n][i]);
        }
        const auto spline = natural_spline_weights(gamma);
        for (std::size_t i = 0; i < spline.size(); ++i) spline_[i] = static_cast<Real>(spline[i]);
    }

    double alpha() const { return alpha_; }
    double gamma() const { return gamma_; }
    GTRMasking masking() const { return masking_; }

    Real P22(const Slope<Real>& slope) const {
        // Beyond, P22 is below the smallest float.
        const Real t =
            elementary::min(slope.x * slope.x + slope.y * slope.y, static_cast<Real>(1e29));
        const Real ratio = (1 + t) / (1 + t * inverse_alpha2_);
        return peak_ * elementary::pow(ratio, power_) / ((1 + t) * (1 + t));
    }

    Real D(const Direction<Real>& m) const {
        const Real sum = m.z * m.z + (m.x * m.x + m.y * m.y) * inverse_alpha2_;
        const Real value = peak_ * elementary::pow(sum, -power_);
        return m.z > 0 ? value : Real{0};
    }

    Real D_any_length(const Direction<Real>& m) const {
        const Real length2 = dot(m, m);
        const Real sum = m.z * m.z + (m.x * m.x + m.y * m.y) * inverse_alpha2_;
        const Real value = peak_ * elementary::pow(sum / length2, -power_) / (length2 * length2);
        return m.z > 0 ? value : Real{0};
    }

    Real Lambda(const Direction<Real>& v) const {
        if (masking_ == GTRMasking::spline) return spline_lambda(v);
        const Real z = v.z, across2 = v.x * v.x + v.y * v.y;
        // v_z Lambda of each n, with R = sqrt(z^2 + B across^2) and h = (R - z) / (2 R): h R,
        // h^2 R and h^3 (z + 3 R) / 2.
        return sum_lobes([&](Real B, Real w2, Real w3, Real w4, auto powers) {
                   const Real b = B * across2, root = std::sqrt(z * z + b);
                   if constexpr (powers.value == 2) return w2 * b / (2 * (root + z));
                   const Real h = b / (2 * root * (root + z));
                   return h * (root * w2 + h * (root * w3 + h * (z + 3 * root) / 2 * w4));
               }) /
               z;
    }

    Real G1(const Direction<Real>& v) const {
        if (!(v.z > 0)) return 0;
        if (masking_ == GTRMasking::spline) return 1 / (1 + spline_lambda(v));
        return std::min(Real{1}, v.z / projected_area(v));
    }

    /// With the exact masking, whichever is chosen.
    Real projected_area(const Direction<Real>& v) const {
        const Real across2 = v.x * v.x + v.y * v.y;
        return sum_lobes([&](Real B, Real w2, Real w3, Real w4, auto powers) {
            return lobe_area<powers.value>(v.z, across2, B, w2, w3, w4);
        });
    }

    /// cos^2(theta) by the inverse of the distribution function.
    Direction<Real> sample(const Uniform<Real>& u) const {
        const auto [cosine, sine] = elementary::turn(u.y);
        const Real sin2 = sample_sin2(u.x), radius = std::sqrt(sin2);
        return {radius * cosine, radius * sine, std::sqrt(1 - sin2)};
    }

    /// Exact: of a lobe, picked by its projected area.
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        const Real across2 = v.x * v.x + v.y * v.y;
        return for_powers([&](auto powers) {
            const Shares area(count_, [&](std::size_t i) {
                return lobe_area<powers.value>(v.z, across2, B_[i], weight_[0][i], weight_[1][i],
                                               weight_[2][i]);
            });
            const auto [i, place] = area.pick(u.x);
            const Real beta = lobe_alpha_[i];
            const Direction<Real> w = normalized(Direction<Real>{beta * v.x, beta * v.y, v.z});
            Direction<Real> h;
            if constexpr (powers.value == 2) {
                h = sample_visible_ggx(w, {place, u.y});
            } else {
                const Real rest = place * area[i];
                const Real ggx = lobe_area<2>(v.z, across2, B_[i], weight_[0][i], 0, 0);
                const Real student = lobe_area<4>(v.z, across2, B_[i], 0, weight_[1][i], 0);
                if (rest < ggx) {
                    h = sample_visible_ggx(w, {rest / ggx, u.y});
                } else {
                    const bool third = rest - ggx < student || greatest_power_ == 3;
                    const Real part = third ? student : area[i] - ggx - student;
                    const Real left = rest - ggx - (third ? Real{0} : student);
                    h = sample_visible_student(third ? 1 : 2, w,
                                               {u.y, std::clamp(left / part, Real{0}, Real{1})});
                }
            }
            return normalized(Direction<Real>{beta * h.x, beta * h.y, h.z});
        });
    }

    /// Drawn from sample() or, with the probability alpha, so that the direction that reflects v is
    /// uniform above the horizon (microsurface-transformations, appendix B, which leaves the
    /// probability open). `u` is used twice.
    Direction<Real> sample_mixed(const Direction<Real>& v, const Uniform<Real>& u) const {
        const auto share = static_cast<Real>(alpha_);
        if (u.y >= share)
            return sample({u.x, share < 1 ? std::min(Real{1}, (u.y - share) / (1 - share)) : u.y});
        const auto [cosine, sine] = elementary::turn(u.y / share);
        const Real radius = std::sqrt(std::max(Real{0}, (1 - u.x) * (1 + u.x)));
        return normalized(Direction<Real>{v.x + radius * cosine, v.y + radius * sine, v.z + u.x});
    }

    /// The density of sample_mixed(), per steradian: that of both ways.
    Real pdf_mixed(const Direction<Real>& v, const Direction<Real>& m) const {
        const auto share = static_cast<Real>(alpha_);
        const Real facing = dot(v, m);
        const bool above = facing > 0 && 2 * facing * m.z > v.z;
        const Real uniform = above ? 2 * std::numbers::inv_pi_v<Real> * facing : Real{0};
        return m.z > 0 ? share * uniform + (1 - share) * D(m) * m.z : Real{0};
    }

    /// Visible normals for reflection of a unit vector v (see bounded_normals.h), under M of a
    /// lobe_frame(M). Throws InvalidInput for gamma > 2, whose lobes are not all GGX.
    Direction<Real> sample_bounded(const Direction<Real>& v, const Uniform<Real>& u,
                                   const LobeFrame<Real>& frame = {}) const {
        return bounded(v, frame).sample(u);
    }

    /// The density of sample_bounded(), per steradian of m; that of the reflected direction is
    /// this over 4 v.m.
    Real pdf_bounded(const Direction<Real>& v, const Direction<Real>& m,
                     const LobeFrame<Real>& frame = {}) const {
        // D under M (eq. 22), which is diag(1 / x, 1 / y) in the frame.
        const Direction<Real> turned = frame.into(m);
        const Direction<Real> base{turned.x / frame.x, turned.y / frame.y, m.z};
        const Real length2 = dot(base, base);
        const Real density = D(normalized(base)) / (frame.x * frame.y * length2 * length2);
        return bounded(v, frame).pdf(m, density);
    }

    // The same for arrays, on thread_count() threads. Throws InvalidInput unless all have one
    // length.
    LTMD_API void sample_mixed(std::span<const Direction<Real>> v, std::span<const Uniform<Real>> u,
                               std::span<Direction<Real>> out) const;
    LTMD_API void pdf_mixed(std::span<const Direction<Real>> v, std::span<const Direction<Real>> m,
                            std::span<Real> out) const;
    LTMD_API void sample_bounded(std::span<const Direction<Real>> v,
                                 std::span<const Uniform<Real>> u, const LobeFrame<Real>& frame,
                                 std::span<Direction<Real>> out) const;
    LTMD_API void pdf_bounded(std::span<const Direction<Real>> v,
                              std::span<const Direction<Real>> m, const LobeFrame<Real>& frame,
                              std::span<Real> out) const;

private:
    using Shares = LobeShares<Real, GTRLobes::capacity>;
    static constexpr std::size_t lanes = Shares::lanes;

    BoundedNormals<Real> bounded(const Direction<Real>& v, const LobeFrame<Real>& frame) const {
        if (greatest_power_ > 2)
            throw InvalidInput("bounded visible normals need gamma <= 2, not " +
                               std::to_string(gamma_));
        return {lobe_alpha_.data(), weight_[0].data(), count_, v, frame};
    }

    template <int n>
    struct Powers {
        static constexpr int value = n;
    };
    /// function(Powers<2>) if all lobes are GGX's, else function(Powers<4>).
    template <class Function>
    auto for_powers(const Function& function) const {
        return greatest_power_ == 2 ? function(Powers<2>{}) : function(Powers<4>{});
    }

    /// The sum of term(B, weights, powers) over the lobes, in lanes so that it vectorises.
    template <class Term>
    Real sum_lobes(const Term& term) const {
        return for_powers([&](auto powers) {
            std::array<Real, lanes> sum{};
            for (std::size_t i = 0; i < count_; i += lanes)
                for (std::size_t j = 0; j < lanes; ++j)
                    sum[j] += term(B_[i + j], weight_[0][i + j], weight_[1][i + j],
                                   weight_[2][i + j], powers);
            return (sum[0] + sum[1]) + (sum[2] + sum[3]);
        });
    }

    /// v_z (1 + Lambda) of the lobes of one B.
    template <int powers>
    static Real lobe_area(Real z, Real across2, Real B, Real w2, Real w3, Real w4) {
        const Real root = std::sqrt(z * z + B * across2);
        if constexpr (powers == 2) return w2 * (z + root) / 2;
        const Real h = (1 - z / root) / 2;
        return (w2 + w3 + w4) * z + h * (root * w2 + h * (root * w3 + h * (z + 3 * root) / 2 * w4));
    }

    /// 1/S - 1 of the average visibility S (appendix A).
    Real spline_lambda(const Direction<Real>& v) const {
        const Real z = v.z, across2 = v.x * v.x + v.y * v.y;
        const Real a = std::sqrt(z * z + alpha2_ * across2), b = std::sqrt(z * z + across2);
        // B_1 - A_1 of eq. 36.
        const Real difference = sine2_ * across2 / (a + b);
        const Real lambda1 = log_range_ > 0
                                 ? (difference - z * std::log1p(difference / (z + a))) / log_range_
                                 : across2 / (2 * (z + b));
        const Real h = alpha2_ * across2 / (2 * a * (a + z));
        const Real lambda2 = h * a;
        const Real lambda3 = h * a * (2 * alpha2_ + h * sine2_) / (1 + alpha2_);
        const Real lambda4 = h *
                             (3 * alpha2_ * (alpha2_ * a + h * a * sine2_) +
                              h * h * (z + 3 * a) / 2 * sine2_ * sine2_) /
                             (1 + alpha2_ * (1 + alpha2_));
        const std::array<Real, 5> lambda{across2 / (2 * (z + b)), lambda1, lambda2, lambda3,
                                         lambda4};
        Real S = 0;
        for (std::size_t i = 0; i < lambda.size(); ++i) S += spline_[i] * z / (z + lambda[i]);
        return 1 / std::clamp(S, std::numeric_limits<Real>::min(), Real{1}) - 1;
    }

    /// sin^2(theta_m) of the share u of the normals nearest to the pole.
    Real sample_sin2(Real u) const {
        // log((1 - (1 - alpha^2) cos^2) / alpha^2); where a factor vanishes it is e = u log_range_,
        // and sin^2 = u for alpha = 1. Sums, as choices by members would become branches.
        const Real e = u * sample_linear_ - elementary::log1p(u * sample_scale_) * sample_factor_;
        const Real sin2 =
            u * sample_flat_ + sample_ratio_ * elementary::expm1(elementary::min(e, log_range_));
        return elementary::min(Real{1}, sin2);
    }

    double alpha_, gamma_;
    GTRMasking masking_;
    Real alpha2_, inverse_alpha2_, sine2_, power_, peak_;
    Real log_range_, sample_scale_, sample_factor_, sample_linear_, sample_ratio_, sample_flat_;
    int greatest_power_;
    std::size_t count_;
    std::array<Real, GTRLobes::capacity> B_, lobe_alpha_;
    std::array<std::array<Real, GTRLobes::capacity>, 3> weight_{};
    std::array<Real, 5> spline_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(GTR<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(GTR<double>);

}  // namespace ltmd::inline v0
