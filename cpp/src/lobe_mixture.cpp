// SPDX-License-Identifier: Apache-2.0
#include "ltmd/lobe_mixture.h"

#include <algorithm>
#include <string>

#include "for_items.h"
#include "gauss_quadrature.h"
#include "lobe_table.h"
#include "ltmd/gtr.h"

namespace ltmd::inline v0 {
namespace {

/// e^-z 1F1(gamma; 2; z) for z >= 0, gamma > 0: the power series, then the asymptotic one.
double scaled_kummer(double gamma, double z) {
    double term = 1, sum = 1;
    if (z < 40) {
        for (int k = 0; term > sum * 1e-17; ++k) {
            term *= (gamma + k) * z / ((2 + k) * (k + 1.0));
            sum += term;
        }
        return sum * std::exp(-z);
    }
    for (int k = 0; k < 40 && std::abs(term) > 1e-17; ++k) {
        term *= (1 - gamma + k) * (2 - gamma + k) / ((k + 1) * z);
        sum += term;
    }
    return sum * std::pow(z, gamma - 2) / std::tgamma(gamma);
}

constexpr int alpha_steps = LTMD_LOBE_TABLE_ALPHA_STEPS;
constexpr int gamma_steps = LTMD_LOBE_TABLE_GAMMA_STEPS;

/// The table of gamma <= 2 or beyond for so many lobes:
/// [alpha_steps + 1][gamma_steps + 1][place, weight][lobes].
std::span<const double> lobe_table(bool beyond, int lobes) {
    static constexpr double to_2_1[] = {LTMD_LOBE_TABLE_TO_2_1};
    static constexpr double to_2_2[] = {LTMD_LOBE_TABLE_TO_2_2};
    static constexpr double to_2_3[] = {LTMD_LOBE_TABLE_TO_2_3};
    static constexpr double to_2_4[] = {LTMD_LOBE_TABLE_TO_2_4};
    static constexpr double to_2_5[] = {LTMD_LOBE_TABLE_TO_2_5};
    static constexpr double to_2_6[] = {LTMD_LOBE_TABLE_TO_2_6};
    static constexpr double to_4_1[] = {LTMD_LOBE_TABLE_TO_4_1};
    static constexpr double to_4_2[] = {LTMD_LOBE_TABLE_TO_4_2};
    static constexpr double to_4_3[] = {LTMD_LOBE_TABLE_TO_4_3};
    static constexpr double to_4_4[] = {LTMD_LOBE_TABLE_TO_4_4};
    static constexpr double to_4_5[] = {LTMD_LOBE_TABLE_TO_4_5};
    static constexpr double to_4_6[] = {LTMD_LOBE_TABLE_TO_4_6};
    static constexpr std::span<const double> tables[2][6] = {
        {to_2_1, to_2_2, to_2_3, to_2_4, to_2_5, to_2_6},
        {to_4_1, to_4_2, to_4_3, to_4_4, to_4_5, to_4_6}};
    return tables[beyond][lobes - 1];
}

/// Where alpha lies between the table's first and last, 0 ... 1.
double alpha_node(bool beyond, double alpha) {
    const double range = -2 * std::log(alpha), most = -2 * std::log(1e-4);
    return beyond ? range / (range + 3) * (most + 3) / most : range / most;
}

/// Lagrange's cubic through four neighbours of x, which lies between the two in the middle but at
/// the ends: the first neighbour and the weights. Continuous.
struct Stencil {
    int first;
    double weight[4];
};
Stencil stencil(double x, int steps) {
    const int first = std::clamp(static_cast<int>(x) - 1, 0, steps - 3);
    const double t = x - first;
    return {first,
            {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
             -t * (t - 1) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6}};
}

double max_relative_error(double alpha, double gamma, std::span<const MixtureLobe> lobes) {
    const GTR<double> exact(alpha, gamma);
    const LobeMixture<double> mixture(lobes);
    constexpr int count = 1000;
    double u[count], p[count], peak = 0, error = 0;
    const double first = 2 * std::log(alpha) - 9, last = 16;
    for (int i = 0; i < count; ++i) {
        u[i] = std::exp(first + (last - first) * i / (count - 1));
        p[i] = exact.P22({std::sqrt(u[i]), 0});
        peak = std::max(peak, u[i] * p[i]);
    }
    for (int i = 0; i < count; ++i)
        if (u[i] * p[i] >= 1e-3 * peak)
            error = std::max(error, std::abs(mixture.P22({std::sqrt(u[i]), 0}) / p[i] - 1));
    return error;
}

}  // namespace

std::vector<MixtureLobe> normalized_lobes(std::span<const MixtureLobe> lobes) {
    constexpr std::size_t most = LobeMixture<double>::capacity;
    if (lobes.empty() || lobes.size() > most)
        throw InvalidInput("a mixture of " + std::to_string(lobes.size()) + " lobes; 1 to " +
                           std::to_string(most) + " are allowed");
    double sum = 0;
    for (const MixtureLobe& lobe : lobes) {
        require_range("alpha", lobe.alpha, smallest_alpha, largest_alpha);
        sum += require_range("weight", lobe.weight, 0, std::numeric_limits<double>::max());
    }
    if (!(sum > 0 && std::isfinite(sum)))
        throw InvalidInput("the weights of a mixture must have a positive, finite sum");
    std::vector<MixtureLobe> all(lobes.begin(), lobes.end());
    std::stable_partition(all.begin(), all.end(),
                          [](const MixtureLobe& lobe) { return lobe.kind == LobeKind::ggx; });
    for (MixtureLobe& lobe : all) lobe.weight /= sum;
    return all;
}

std::vector<MixtureLobe> gtr_ggx_lobes(double alpha, double gamma, int count) {
    require_range("gamma", gamma, 0, 2);
    const GTRLobes exact = gtr_lobes(alpha, gamma, count);
    std::vector<MixtureLobe> lobes;
    for (std::size_t i = 0; i < exact.count; ++i)
        lobes.push_back({LobeKind::ggx, std::sqrt(exact.B[i]), exact.weight[0][i]});
    return lobes;
}

std::vector<MixtureLobe> gtr_beckmann_lobes(double alpha, double gamma, int count) {
    require_range("alpha", alpha, 1e-4, 1);
    require_range("gamma", gamma, 1e-3, 4);
    require_range("count", count, 1, static_cast<double>(LobeMixture<double>::capacity));
    // In log t the density falls like t below 1, and like e^(-alpha^2 t) above 1 / alpha^2.
    const double alpha2 = alpha * alpha, low = std::log(1e-12), high = std::log(60 / alpha2);
    std::vector<QuadratureNode> measure;
    constexpr int points = 600;
    for (int i = 0; i < points; ++i) {
        const double log_t = low + (high - low) * (i + 0.5) / points, t = std::exp(log_t);
        const double weight =
            t * std::exp(-alpha2 * t) * scaled_kummer(gamma, (1 - alpha) * (1 + alpha) * t);
        measure.push_back({log_t, weight});
    }
    std::vector<MixtureLobe> lobes;
    double sum = 0;
    const auto rule = gauss_rule(measure, count);
    for (const auto& node : rule) sum += node.weight;
    for (const auto& node : rule)
        lobes.push_back({LobeKind::beckmann, std::exp(-node.x / 2), node.weight / sum});
    return lobes;
}

FittedLobes fit_lobes(double alpha, double gamma, int max_lobes) {
    require_range("alpha", alpha, 1e-4, 1);
    require_range("gamma", gamma, 0, 4);
    require_range("max_lobes", max_lobes, 1, 6);
    const bool beyond = gamma > 2;
    const auto table = lobe_table(beyond, max_lobes);
    const auto n = static_cast<std::size_t>(max_lobes);
    const Stencil a = stencil(alpha_node(beyond, alpha) * alpha_steps, alpha_steps);
    const Stencil g = stencil(4 * (gamma - (beyond ? 2 : 0)), gamma_steps);
    std::vector<double> values(2 * n, 0);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const auto row =
                static_cast<std::size_t>((a.first + i) * (gamma_steps + 1) + g.first + j);
            for (std::size_t k = 0; k < 2 * n; ++k)
                values[k] += a.weight[i] * g.weight[j] * table[row * 2 * n + k];
        }
    const double log_alpha2 = 2 * std::log(alpha);
    const double most = *std::max_element(values.begin() + max_lobes, values.end());
    FittedLobes fitted{};
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
        // How the weights vanish at the borders.
        double factor = 1;
        if (beyond && k > 0) factor = (gamma - 2) * (1 - alpha) * (1 + alpha);
        if (!beyond && n > 1) factor = (k > 0 ? gamma : 1) * (k + 1 < n ? 2 - gamma : 1);
        const double weight = factor * std::exp(values[n + k] - most);
        if (!(weight > 0)) continue;
        const double log_B =
            beyond ? log_alpha2 + values[k] : log_alpha2 * std::clamp(values[k], 0.0, 1.0);
        fitted.lobes.push_back(
            {beyond && k > 0 ? LobeKind::beckmann : LobeKind::ggx, std::exp(log_B / 2), weight});
        sum += weight;
    }
    for (MixtureLobe& lobe : fitted.lobes) lobe.weight /= sum;
    fitted.max_relative_error = max_relative_error(alpha, gamma, fitted.lobes);
    return fitted;
}

template <std::floating_point R>
void LobeMixture<R>::sample_bounded(std::span<const Direction<R>> v, std::span<const Uniform<R>> u,
                                    const LobeFrame<R>& frame, std::span<Direction<R>> out) const {
    for_items(out, [&](auto& a, auto& b) { return sample_bounded(a, b, frame); }, v, u);
}
template <std::floating_point R>
void LobeMixture<R>::pdf_bounded(std::span<const Direction<R>> v, std::span<const Direction<R>> m,
                                 const LobeFrame<R>& frame, std::span<R> out) const {
    for_items(out, [&](auto& a, auto& b) { return pdf_bounded(a, b, frame); }, v, m);
}

template class LobeMixture<float>;
template class LobeMixture<double>;
template AnyDistribution<float>::AnyDistribution(LobeMixture<float>);
template AnyDistribution<double>::AnyDistribution(LobeMixture<double>);

}  // namespace ltmd::inline v0
