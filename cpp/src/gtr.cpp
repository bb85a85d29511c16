// SPDX-License-Identifier: Apache-2.0
#include "ltmd/gtr.h"

#include <algorithm>
#include <vector>

#include "for_items.h"
#include "gauss_quadrature.h"

namespace ltmd::inline v0 {
namespace {

/// A point of the mixture's parameter: y = 1 - x, both to their own precision.
struct Point {
    double x, y, weight;
};

/// The distribution Beta(g, 2 - g) of x as points dense enough for 1 / (alpha^2 + (1 - alpha^2) y)
/// and polynomials of its logarithm; not normalised.
std::vector<Point> beta_points(double alpha2, double g) {
    constexpr int order = 16;
    std::vector<Point> points;
    for (const auto& node : gauss_jacobi(order, g, 1)) {
        const double x = node.x / 2;
        points.push_back({x, 1 - x, node.weight * std::pow(0.5, g) * std::pow(1 - x, 1 - g)});
    }
    // Panels that grow fourfold from the pole at y = -alpha^2 / (1 - alpha^2).
    const double first = std::min(0.5, alpha2);
    for (const auto& node : gauss_jacobi(order, 2 - g, 1)) {
        const double y = node.x * first;
        points.push_back({1 - y, y, node.weight * std::pow(first, 2 - g) * std::pow(1 - y, g - 1)});
    }
    static const auto legendre = gauss_jacobi(order, 1, 1);
    const int panels = static_cast<int>(std::ceil(std::log(0.5 / first) / std::log(4.0)));
    for (int i = 0; i < panels; ++i) {
        const double width = std::log(0.5 / first) / panels;
        for (const auto& node : legendre) {
            const double y = first * std::exp(width * (i + node.x));
            points.push_back(
                {1 - y, y, node.weight * width * y * std::pow(y, 1 - g) * std::pow(1 - y, g - 1)});
        }
    }
    return points;
}

}  // namespace

GTRLobes gtr_lobes(double alpha, double gamma, int nodes) {
    require_range("alpha", alpha, 1e-4, 1);
    require_range("gamma", gamma, 0, 4);
    require_range("nodes", nodes, 1, static_cast<double>(GTRLobes::capacity));
    if (alpha == 1) gamma = 2;  // all are GGX(1)
    const double alpha2 = alpha * alpha, sine2 = (1 - alpha) * (1 + alpha);
    const int derivatives = gamma > 3 ? 2 : gamma > 2 ? 1 : 0;
    const double g = gamma - derivatives;

    GTRLobes lobes;
    lobes.greatest_power = 2 + derivatives;
    // The masses of (t + B)^-2 and of its derivatives' terms, per unit of the distribution of x.
    const auto masses = [&](double x, double B) {
        const double k = sine2 * x / (g * B);
        std::array<double, 3> mass{1 / B, 0, 0};
        if (derivatives == 1) mass[1] = k / B;
        if (derivatives == 2) {
            mass[1] = 2 * k / B;
            mass[2] = 2 * k * k * g / ((g + 1) * B);
        }
        return mass;
    };
    const auto add = [&](double x, double B, double weight) {
        const auto mass = masses(x, B);
        const double sum = mass[0] + mass[1] + mass[2];
        lobes.B[lobes.count] = B;
        for (std::size_t n = 0; n < 3; ++n) lobes.weight[n][lobes.count] = weight * mass[n] / sum;
        ++lobes.count;
    };
    if (g == 0 || g == 2) {  // x is 0 or 1
        add(g / 2, g == 0 ? 1 : alpha2, 1);
        return lobes;
    }
    // In log B over its range, with sqrt(B) in the measure so that the tails keep their precision.
    const double range = -2 * std::log(alpha);
    std::vector<QuadratureNode> measure;
    for (const Point& point : beta_points(alpha2, g)) {
        const double B = alpha2 + sine2 * point.y;
        const double log_B = point.y > 0.5 ? std::log1p(-sine2 * point.x) : std::log(B);
        const auto mass = masses(point.x, B);
        measure.push_back(
            {log_B / range, point.weight * (mass[0] + mass[1] + mass[2]) * std::sqrt(B)});
    }
    // More than needed would only pick up the rounding of the points.
    auto rule = gauss_rule(measure, std::min(nodes, gtr_node_count(alpha, gamma, false)));
    double sum = 0;
    for (auto& node : rule) sum += node.weight /= std::exp(node.x * range / 2);
    for (const auto& node : rule) {
        const double log_B = node.x * range;
        add(std::clamp(-std::expm1(log_B) / sine2, 0.0, 1.0), std::exp(log_B), node.weight / sum);
    }
    return lobes;
}

int gtr_node_count(double alpha, double gamma, bool single_precision) {
    const double range = -2 * std::log(alpha);
    const double count = gamma <= 2 ? (single_precision ? 5 + 0.6 * range : 8 + 1.6 * range)
                                    : (single_precision ? 6 + range : 10 + 1.6 * range);
    return 4 * static_cast<int>(std::ceil(std::min(count, 40.0) / 4));
}

std::array<double, 5> natural_spline_weights(double gamma) {
    const int i = std::clamp(static_cast<int>(gamma), 0, 3);
    const double b = gamma - i, a = 1 - b;
    // The second derivatives at 1, 2, 3 from 6 (y_{k-1} - 2 y_k + y_{k+1}) by the inverse of
    // [4 1 0; 1 4 1; 0 1 4].
    constexpr double inverse[3][3] = {{15, -4, 1}, {-4, 16, -4}, {1, -4, 15}};
    std::array<double, 5> weights{};
    for (int j = 0; j < 5; ++j) {
        double second[5] = {};
        for (int row = 0; row < 3; ++row)
            for (int k = 0; k < 3; ++k) {
                const int offset = j - (k + 1);
                const double difference = offset == 0 ? -2 : offset == 1 || offset == -1 ? 1 : 0;
                second[row + 1] += inverse[row][k] / 56 * 6 * difference;
            }
        weights[static_cast<std::size_t>(j)] =
            (i == j       ? a
             : i + 1 == j ? b
                          : 0) +
            ((a * a * a - a) * second[i] + (b * b * b - b) * second[i + 1]) / 6;
    }
    return weights;
}

template <std::floating_point R>
void GTR<R>::sample_mixed(std::span<const Direction<R>> v, std::span<const Uniform<R>> u,
                          std::span<Direction<R>> out) const {
    for_items(out, [&](auto& a, auto& b) { return sample_mixed(a, b); }, v, u);
}
template <std::floating_point R>
void GTR<R>::pdf_mixed(std::span<const Direction<R>> v, std::span<const Direction<R>> m,
                       std::span<R> out) const {
    for_items(out, [&](auto& a, auto& b) { return pdf_mixed(a, b); }, v, m);
}
template <std::floating_point R>
void GTR<R>::sample_bounded(std::span<const Direction<R>> v, std::span<const Uniform<R>> u,
                            const LobeFrame<R>& frame, std::span<Direction<R>> out) const {
    for_items(out, [&](auto& a, auto& b) { return sample_bounded(a, b, frame); }, v, u);
}
template <std::floating_point R>
void GTR<R>::pdf_bounded(std::span<const Direction<R>> v, std::span<const Direction<R>> m,
                         const LobeFrame<R>& frame, std::span<R> out) const {
    for_items(out, [&](auto& a, auto& b) { return pdf_bounded(a, b, frame); }, v, m);
}

template class GTR<float>;
template class GTR<double>;
template AnyDistribution<float>::AnyDistribution(GTR<float>);
template AnyDistribution<double>::AnyDistribution(GTR<double>);

}  // namespace ltmd::inline v0
