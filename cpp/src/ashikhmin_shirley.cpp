// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ashikhmin_shirley.h"

#include <array>

#include "find_root.h"
#include "gauss_legendre.h"

namespace ltmd::inline v0 {
namespace {

using std::numbers::pi;

// Below e^-largest_z no slope is drawn.
constexpr double largest_z = 80;

// The table: angles of a line to the view, angles of the view with one more at each end, steps of
// the cotangent's logarithm.
constexpr std::size_t angles = 49, turns = 19;
constexpr double angle_step = pi / (angles - 1), turn_step = pi / 2 / (turns - 3);
constexpr double log_step = 1.0 / 12;

/// Lagrange's weights of the points 0, 1, 2, 3 at t.
std::array<double, 4> cubic_weights(double t) {
    const double a = t - 1, b = t - 2, c = t - 3;
    return {-a * b * c / 6, t * b * c / 2, -t * a * c / 2, t * a * b / 6};
}

/// The four of `count` points that surround x, counted in steps, and their weights.
struct Cubic {
    std::size_t first;
    std::array<double, 4> weight;

    Cubic(double x, std::size_t count) {
        const double from = std::clamp(std::floor(x) - 1, 0.0, static_cast<double>(count - 4));
        first = static_cast<std::size_t>(from);
        weight = cubic_weights(x - from);
    }
};

/// z = -log of the probability to exceed t.
double z_of(double k, double t) { return std::log1p(k * t * t) / (2 * k); }
double t_of(double k, double z) { return std::sqrt(std::expm1(2 * k * z) / k); }

/// The mean of t - t0 over t > t0, tabulated as its ratio to (1 + k t0^2) / sqrt(1 + t0^2) over k
/// and t0 / (1 + t0).
class MeanExcess {
public:
    MeanExcess() {
        for (std::size_t i = 0; i < ks; ++i) {
            const double k = std::max(1e-14, k_step * static_cast<double>(i));
            for (std::size_t j = 0; j < ts; ++j) {
                const double y = static_cast<double>(j) / ts;
                const double t = y / (1 - y);
                ratio_.push_back(by_quadrature(k, t) / scale(k, t));
            }
        }
    }

    double operator()(double k, double t) const {
        const Cubic in_k(k / k_step, ks), in_t(t / (1 + t) * ts, ts);
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const double* row = &ratio_[(in_k.first + i) * ts + in_t.first];
            double part = 0;
            for (std::size_t j = 0; j < 4; ++j) part += in_t.weight[j] * row[j];
            sum += in_k.weight[i] * part;
        }
        return sum * scale(k, t);
    }

private:
    static constexpr std::size_t ks = 33, ts = 129;
    static constexpr double k_step = 0.5 / (ks - 1);

    static double scale(double k, double t) { return (1 + k * t * t) / std::sqrt(1 + t * t); }

    /// The integral over z of e^-z (t(z0 + z) - t0), z = x^2: smooth in x; e^-z t falls as
    /// e^(-z/2).
    static double by_quadrature(double k, double t) {
        constexpr int panels = 32;
        double sum = 0;
        for (int i = 0; i < panels; ++i) {
            const double low = 9.0 * i * i / (panels * panels);
            const double width = 9.0 * (2 * i + 1) / (panels * panels);
            for (const auto [node, weight] : gauss8) {
                const double x = low + width * node, z = x * x;
                // t(z0 + z) - t0 without cancellation.
                const double rise = (1 + k * t * t) * std::expm1(2 * k * z) / k;
                const double there = std::sqrt(t * t + rise);
                sum += width * weight * 2 * x * std::exp(-z) * rise / (there + t);
            }
        }
        return sum;
    }

    std::vector<double> ratio_;
};

double mean_excess(double k, double t) {
    static const MeanExcess table;
    return table(k, t);
}

/// The radial distribution on one line: the integral of P(t' > t) beyond t.
double excess(double k, double t) {
    const double z = z_of(k, t);
    return z < largest_z ? std::exp(-z) * mean_excess(k, t) : 0;
}

}  // namespace

/// A view in the quadrant x, y >= 0 of stretched slopes.
struct AshikhminShirleyNormals::View {
    double across, cotangent, angle;
    Cubic turn, row;
};

AshikhminShirleyNormals::AshikhminShirleyNormals(double nx, double ny)
    : alpha_x_(1 / std::sqrt(nx + 2)), alpha_y_(1 / std::sqrt(ny + 2)), log_low_(std::log(1e-3)) {
    // To the cotangent from where the excess is below 1e-9 of it for the slowest of the tails.
    const double k = std::max(alpha_x_ * alpha_x_, alpha_y_ * alpha_y_);
    double c = 1;
    while (c < 1e5 && excess(k, c) > 1e-9 * c) c *= 1.1;
    cotangents_ = static_cast<std::size_t>((std::log(c) - log_low_) / log_step) + 2;

    std::array<std::array<QuadratureNode, 4>, angles - 1> cosines;
    constexpr std::array<QuadratureNode, 4> gauss4{{{0.069431844202973712, 0.173927422568726929},
                                                    {0.330009478207571868, 0.326072577431273071},
                                                    {0.669990521792428132, 0.326072577431273071},
                                                    {0.930568155797026288, 0.173927422568726929}}};
    for (std::size_t i = 0; i + 1 < angles; ++i)
        for (std::size_t n = 0; n < 4; ++n) {
            const double at = static_cast<double>(i) + gauss4[n].x;
            cosines[i][n] = {std::sin(angle_step * at), gauss4[n].weight};
        }
    for (std::size_t turn = 0; turn < turns; ++turn) {
        const double omega = turn_step * (static_cast<double>(turn) - 1);
        for (std::size_t j = 0; j < cotangents_; ++j) {
            c = std::exp(log_low_ + log_step * static_cast<double>(j));
            std::array<double, angles> sums{};
            double above = 0;
            for (std::size_t i = 0; i + 1 < angles; ++i) {
                double sum = 0;
                for (std::size_t n = 0; n < 4; ++n) {
                    const auto [cosine, weight] = cosines[i][n];
                    const double delta =
                        angle_step * (static_cast<double>(i) + gauss4[n].x) - pi / 2;
                    const double here = k_at(omega + delta), tau = c / cosine;
                    sum += weight * cosine * excess(here, tau);
                    above += weight * std::exp(-z_of(here, tau));
                }
                sums[i + 1] = sums[i] + angle_step * sum / (2 * pi);
            }
            const double total = sums.back();
            excess_area_.push_back(total);
            above_.push_back(above * angle_step / (2 * pi));
            for (std::size_t i = 0; i < angles; ++i)
                share_.push_back(total > 0 ? sums[i] / total
                                           : static_cast<double>(i) / (angles - 1));
        }
    }
}

double AshikhminShirleyNormals::k_at(double xi) const {
    const double x = alpha_x_ * std::cos(xi), y = alpha_y_ * std::sin(xi);
    return x * x + y * y;
}

AshikhminShirleyNormals::View AshikhminShirleyNormals::view_of(const Direction<double>& v) const {
    const double x = std::abs(alpha_x_ * v.x), y = std::abs(alpha_y_ * v.y);
    const double across = std::hypot(x, y);
    const double c = std::clamp(v.z / across, 0.0, 1e30), angle = std::atan2(y, x);
    const double j = c > 0 ? (std::log(c) - log_low_) / log_step : 0.0;
    return {across, c, angle, Cubic(angle / turn_step + 1, turns),
            Cubic(std::clamp(j, 0.0, static_cast<double>(cotangents_ - 1)), cotangents_)};
}

/// The integral of P22(t) max(0, t_x - c), t_x towards the view.
double AshikhminShirleyNormals::excess_area(const View& view) const {
    const double c = view.cotangent, x = c > 0 ? (std::log(c) - log_low_) / log_step : -1.0;
    if (!(x < static_cast<double>(cotangents_ - 1))) return 0;
    const auto j = static_cast<std::size_t>(std::max(0.0, x));
    const double low = x < 0 ? 0 : std::exp(log_low_ + log_step * static_cast<double>(j));
    const double high = std::exp(log_low_ + log_step * static_cast<double>(x < 0 ? 0 : j + 1));
    const double width = high - low, t = (c - low) / width, s = 1 - t;
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t at = row(view.turn.first + i, j);
        // Hermite's cubic; the derivative by c is -P(t_x > c), -1/2 at c = 0.
        const std::size_t end = x < 0 ? at : at + 1;
        double start = excess_area_[at], slope = -above_[at];
        if (x < 0) {
            // From Hermite's cubic itself, so that it is quadratic below the first row.
            slope = -0.5;
            start = excess_area_[at] + width * (above_[at] + 0.5) / 2;
        }
        sum += view.turn.weight[i] *
               (s * s * ((1 + 2 * t) * start + t * width * slope) +
                t * t * ((3 - 2 * t) * excess_area_[end] + s * width * above_[end]));
    }
    return std::max(0.0, sum);
}

double AshikhminShirleyNormals::projected_area(const Direction<double>& v) const {
    const View view = view_of(v);
    return v.z + view.across * excess_area(view);
}

Slope<double> AshikhminShirleyNormals::sample(const Uniform<double>& u) const {
    const double xi = 2 * pi * u.y, k = k_at(xi);
    const double t = t_of(k, std::min(largest_z, -std::log1p(-u.x)));
    return {alpha_x_ * t * std::cos(xi), alpha_y_ * t * std::sin(xi)};
}

/// The part of the excess area on lines before the k-th.
double AshikhminShirleyNormals::share(const View& view, std::size_t k) const {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            sum += view.turn.weight[i] * view.row.weight[j] *
                   share_[row(view.turn.first + i, view.row.first + j) * angles + k];
    return sum;
}

Slope<double> AshikhminShirleyNormals::sample_visible(const Direction<double>& v,
                                                      const Uniform<double>& u) const {
    const View view = view_of(v);
    const double c = view.cotangent, excess_all = excess_area(view);

    // The line: Hermite's cubic through the table, with exact derivatives.
    const auto below = [&](std::size_t k) {
        return c * static_cast<double>(k) / (angles - 1) + excess_all * share(view, k);
    };
    const double wanted = u.x * (c + excess_all);
    std::size_t i = 0;
    for (std::size_t end = angles - 2; end > i;) {
        const std::size_t middle = (i + end + 1) / 2;
        if (below(middle) <= wanted)
            i = middle;
        else
            end = middle - 1;
    }
    const auto line = [&](double at) {
        const double delta = std::clamp(angle_step * at - pi / 2, -pi / 2, pi / 2);
        const double cosine = std::max(1e-16, std::cos(delta));
        return std::array{delta, cosine, k_at(view.angle + delta)};
    };
    const auto derivative = [&](std::size_t node) {
        const auto [delta, cosine, k] = line(static_cast<double>(node));
        return angle_step * (c / pi + cosine * excess(k, c / cosine) / (2 * pi));
    };
    const double p0 = below(i), rise = below(i + 1) - p0;
    const double d0 = derivative(i), d1 = derivative(i + 1);
    const double b = 3 * rise - 2 * d0 - d1, a = d0 + d1 - 2 * rise;
    const double at = find_root(0, 1, 0.5, [&](double x) {
        return std::pair(p0 - wanted + x * (d0 + x * (b + x * a)), d0 + x * (2 * b + 3 * a * x));
    });
    const auto [delta, cosine, k] = line(static_cast<double>(i) + at);

    // Along the line, from the far end that faces the view to where it turns away; moment is the
    // integral of t over its density beyond t, area that of the density.
    const double tau = c / cosine, back = c + cosine * excess(k, 0);
    const double y = u.y * (2 * c + cosine * excess(k, tau));
    const auto moment = [k = k](double t, double area) { return area * (t + mean_excess(k, t)); };
    double t;
    if (y < back) {
        // As a logarithm it is nearly linear in z, and falls slower than -z.
        const double log_y = std::log(y), guess = std::min(largest_z, std::log(back) - log_y);
        const double z = find_root(0, largest_z, guess, [&, k = k, cosine = cosine](double x) {
            const double there = t_of(k, x), area = std::exp(-x);
            const double beyond = c * area + cosine * moment(there, area);
            return std::pair(log_y - std::log(beyond), (c + cosine * there) * area / beyond);
        });
        t = -t_of(k, z);
    } else {
        const double end = std::min(largest_z, z_of(k, tau));
        const double z = find_root(0, end, end / 2, [&, k = k, cosine = cosine](double x) {
            const double there = t_of(k, x), area = std::exp(-x);
            return std::pair(2 * c - y - c * area + cosine * moment(there, area),
                             (c - cosine * there) * area);
        });
        t = std::min(tau, t_of(k, z));
    }
    const double xi = view.angle + delta;
    return {std::copysign(alpha_x_, v.x) * t * std::cos(xi),
            std::copysign(alpha_y_, v.y) * t * std::sin(xi)};
}

template AnyDistribution<float>::AnyDistribution(AshikhminShirley<float>);
template AnyDistribution<double>::AnyDistribution(AshikhminShirley<double>);

}  // namespace ltmd::inline v0
