// SPDX-License-Identifier: Apache-2.0
#include "ltmd/visible_normals.h"

#include <array>
#include <cmath>

#include "find_root.h"
#include "gauss_legendre.h"
#include "ltmd/errors.h"
#include "text.h"

namespace ltmd::inline v0 {
namespace {

using std::numbers::pi;

constexpr double largest_slope = 1e12;

double require_density(double r, double p22) {
    if (p22 >= 0 && std::isfinite(p22)) return p22;
    throw InvalidInput(text("P22 is ", p22, " at the slope ", r, "; it must be finite and >= 0"));
}

/// A cell of a function with its values at both ends and in the middle.
struct Cell {
    double low, high, at_low, at_middle, at_high;

    double bump() const { return 4 * at_middle - 2 * (at_low + at_high); }
    double middle() const { return (low + high) / 2; }
};

double quadratic(double p0, double p1, double bump, double t) {
    return p0 + t * (p1 - p0 + bump * (1 - t));
}

bool is_positive(double p0, double p1, double bump) {
    // The only minimum inside is where bump < 0.
    const double t = (p1 - p0 + bump) / (2 * bump);
    return bump >= 0 || t <= 0 || t >= 1 || quadratic(p0, p1, bump, t) >= 0;
}

/// The integrals of P22 r and P22 r^2, by Simpson's rule.
RadialTable::Tail simpson(const Cell& cell) {
    const double width = (cell.high - cell.low) / 6, middle = cell.middle();
    const double a = cell.at_low * cell.low, b = 4 * cell.at_middle * middle,
                 c = cell.at_high * cell.high;
    return {width * (a + b + c), width * (a * cell.low + b * middle + c * cell.high)};
}

constexpr std::size_t angles = 33;
constexpr double angle_step = pi / 2 / (angles - 1);

}  // namespace

RadialTable::RadialTable(std::span<const double> r, std::span<const double> p22) {
    if (r.size() != p22.size() || r.size() < 2)
        throw InvalidInput(text(r.size(), " slopes and ", p22.size(),
                                " densities; there must be as many of both, 2 or more"));
    if (r[0] > 0) add_node(0, require_density(r[0], p22[0]));
    for (std::size_t i = 0; i < r.size(); ++i) {
        if (!(r[i] >= 0 && r[i] <= largest_slope && (i == 0 || r[i] > r[i - 1])))
            throw InvalidInput(
                text("slope ", i, " is ", r[i], "; slopes must increase within [0, 1e12]"));
        add_node(r[i], require_density(r[i], p22[i]));
    }
    integrate();
}

RadialTable::RadialTable(const Function& p22) {
    const auto evaluate = [&](const std::vector<double>& r) {
        std::vector<double> values = p22(r);
        if (values.size() != r.size())
            throw InvalidInput(text("P22 gave ", values.size(), " densities for ", r.size(),
                                    " slopes; it must give one for each"));
        for (std::size_t i = 0; i < r.size(); ++i) require_density(r[i], values[i]);
        return values;
    };

    // Find where P22 has its mass, on cells of equal width in the logarithm.
    std::vector<double> r{0};
    const double first = std::log(1e-10), last = std::log(largest_slope);
    for (double x = first; x < last; x += 0.125) {
        const double next = std::exp(x);
        r.push_back((r.back() + next) / 2);
        r.push_back(next);
    }
    const std::vector<double> values = evaluate(r);
    std::vector<Cell> pending;
    Tail total{0, 0};
    for (std::size_t i = 0; i + 2 < r.size(); i += 2) {
        pending.push_back({r[i], r[i + 2], values[i], values[i + 1], values[i + 2]});
        const auto [area, moment] = simpson(pending.back());
        total.area += area;
        total.moment += moment;
    }
    if (!(total.area > 0)) throw InvalidInput("P22 must not be 0 at all slopes");
    const auto end = simpson(pending.back());
    if (end.moment > 1e-4 * total.moment)
        throw InvalidInput("P22 falls too slowly: the mean slope must be finite");

    // Leave the ends out that hold nothing; slopes below the first are one cell.
    double rest = 0;
    while (rest + simpson(pending.back()).moment < 1e-10 * total.moment) {
        rest += simpson(pending.back()).moment;
        pending.pop_back();
    }
    std::size_t empty = 0;
    for (rest = 0; rest + simpson(pending[empty]).area < 1e-12 * total.area; ++empty)
        rest += simpson(pending[empty]).area;
    if (empty > 0) {
        const double high = pending[empty].low;
        pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(empty));
        const double middle = evaluate({high / 2})[0];
        pending.insert(pending.begin(), {0, high, values[0], middle, pending[0].at_low});
    }

    // Halve cells until the quadratic through three of its points meets two more.
    constexpr std::size_t largest_count = 1 << 14;
    std::vector<Cell> done;
    while (!pending.empty()) {
        r.clear();
        for (const Cell& cell : pending)
            for (const double t : {0.25, 0.75}) r.push_back(std::lerp(cell.low, cell.high, t));
        const std::vector<double> quarters = evaluate(r);
        std::vector<Cell> halves;
        for (std::size_t i = 0; i < pending.size(); ++i) {
            Cell& cell = pending[i];
            const double a = quarters[2 * i], b = quarters[2 * i + 1];
            const double width = cell.high - cell.low;
            const auto meets = [&](double bump) {
                const auto error = [&](double t, double value) {
                    return std::abs(quadratic(cell.at_low, cell.at_high, bump, t) - value);
                };
                const double e =
                    std::max({error(0.25, a), error(0.75, b), error(0.5, cell.at_middle)});
                const double weighted = e * width * cell.high;
                return e <= 1e-6 * std::min({a, b, cell.at_middle}) ||
                       (weighted <= 1e-8 * total.area &&
                        weighted * cell.high <= 1e-8 * total.moment);
            };
            const bool positive = is_positive(cell.at_low, cell.at_high, cell.bump());
            const bool finest = width <= 1e-12 * cell.high ||
                                done.size() + pending.size() + halves.size() > largest_count;
            if (positive && (finest || meets(cell.bump()))) {
                done.push_back(cell);
            } else if (finest || meets(0)) {
                cell.at_middle = (cell.at_low + cell.at_high) / 2;
                done.push_back(cell);
            } else {
                const double middle = cell.middle();
                halves.push_back({cell.low, middle, cell.at_low, a, cell.at_middle});
                halves.push_back({middle, cell.high, cell.at_middle, b, cell.at_high});
            }
        }
        pending = std::move(halves);
    }
    std::ranges::sort(done, {}, &Cell::low);
    for (const Cell& cell : done) {
        add_node(cell.low, cell.at_low);
        bump_.back() = cell.bump();
    }
    add_node(done.back().high, done.back().at_high);
    integrate();
}

void RadialTable::add_node(double r, double p22) {
    r_.push_back(r);
    p_.push_back(p22);
    bump_.push_back(0);
}

/// The integrals of P22 r and P22 r^2 from a cell's start to t.
struct RadialTable::Partial {
    double area, moment;
};

RadialTable::Partial RadialTable::partial(std::size_t cell, double t) const {
    const double r = r_[cell], width = r_[cell + 1] - r;
    // P22 = a + b t - q t^2.
    const double a = p_[cell], q = bump_[cell], b = p_[cell + 1] - a + q;
    const double i0 = t * (a + t * (b / 2 - t * q / 3));
    const double i1 = t * t * (a / 2 + t * (b / 3 - t * q / 4));
    const double i2 = t * t * t * (a / 3 + t * (b / 4 - t * q / 5));
    return {width * (r * i0 + width * i1),
            width * (r * (r * i0 + 2 * width * i1) + width * width * i2)};
}

void RadialTable::integrate() {
    const auto sum = [&] {
        tail_.assign(r_.size(), {0, 0});
        for (std::size_t i = r_.size() - 1; i-- > 0;) {
            const Partial cell = partial(i, 1);
            tail_[i] = {tail_[i + 1].area + cell.area, tail_[i + 1].moment + cell.moment};
        }
    };
    // Keep the sums within range whatever the scale of P22.
    const double largest = *std::ranges::max_element(p_);
    const double scale = 1 / (largest * r_.back() * r_.back());
    if (!(scale > 0 && std::isfinite(scale))) throw InvalidInput("P22 must not be 0 at all slopes");
    const auto multiply = [&](double factor) {
        for (std::vector<double>* values : {&p_, &bump_})
            for (double& value : *values) value *= factor;
    };
    multiply(scale);
    sum();
    multiply(1 / (2 * pi * tail_[0].area));
    sum();
}

std::size_t RadialTable::cell_of(double r) const {
    const auto after = std::upper_bound(r_.begin() + 1, r_.end() - 1, r);
    return static_cast<std::size_t>(after - r_.begin()) - 1;
}

double RadialTable::P22(double r) const {
    if (!(r <= r_.back())) return 0;
    const std::size_t i = cell_of(r);
    const double t = (r - r_[i]) / (r_[i + 1] - r_[i]);
    return std::max(0.0, quadratic(p_[i], p_[i + 1], bump_[i], t));
}

RadialTable::Tail RadialTable::tail(double r) const {
    if (!(r < r_.back())) return {0, 0};
    const std::size_t i = cell_of(r);
    const Partial part = partial(i, (r - r_[i]) / (r_[i + 1] - r_[i]));
    return {std::max(0.0, tail_[i].area - part.area), std::max(0.0, tail_[i].moment - part.moment)};
}

double RadialTable::excess(double r) const {
    if (!(r < r_.back())) return 0;
    const Tail rest = tail(r);
    return std::max(0.0, rest.moment - r * rest.area);
}

double RadialTable::solve(double area_weight, double moment_weight, double value, double low,
                          double high) const {
    const auto at = [&](const Tail& rest) {
        return area_weight * rest.area + moment_weight * rest.moment;
    };
    std::size_t i = cell_of(low), end = cell_of(high);
    while (end > i) {
        const std::size_t middle = (i + end + 1) / 2;
        if (at(tail_[middle]) >= value)
            i = middle;
        else
            end = middle - 1;
    }
    const double r = r_[i], width = r_[i + 1] - r;
    const double t_low = std::max(0.0, (low - r) / width),
                 t_high = std::min(1.0, (high - r) / width);
    if (!(t_high > t_low)) return std::min(high, r + width * t_low);
    const double wanted = at(tail_[i]) - value, all = at(tail_[i]) - at(tail_[i + 1]);
    const double guess = all > 0 ? std::clamp(wanted / all, t_low, t_high) : t_low;
    const double t = find_root(t_low, t_high, guess, [&](double x) {
        const Partial part = partial(i, x);
        const double at_x = r + width * x;
        return std::pair(area_weight * part.area + moment_weight * part.moment - wanted,
                         width * at_x * (area_weight + moment_weight * at_x) *
                             quadratic(p_[i], p_[i + 1], bump_[i], x));
    });
    return r + width * t;
}

VisibleNormals::VisibleNormals(RadialTable table) : table_(std::move(table)) {
    const double area = table_.tail(0).area, end = table_.nodes().back();
    const double low = 1e-2 * table_.solve(1, 0, (1 - 1e-3) * area, 0, end);
    log_low_ = std::log(low);
    log_step_ = 1.0 / 16;
    for (std::size_t j = 0;; ++j) {
        const double c = std::exp(log_low_ + log_step_ * static_cast<double>(j));
        // The integrals over the angle of cos E(c / cos) and of the tail.
        std::array<double, angles> sums{};
        double above = 0;
        for (std::size_t k = 0; k + 1 < angles; ++k) {
            double sum = 0;
            for (const auto [node, weight] : gauss8) {
                const double cosine = std::cos(angle_step * (static_cast<double>(k) + node));
                const auto rest = table_.tail(c / cosine);
                sum += weight * std::max(0.0, cosine * rest.moment - c * rest.area);
                above += 2 * angle_step * weight * rest.area;
            }
            sums[k + 1] = sums[k] + 2 * angle_step * sum;
        }
        const double total = sums.back();
        c_.push_back(c);
        excess_area_.push_back(total);
        above_.push_back(above);
        for (std::size_t k = 0; k < angles; ++k)
            share_.push_back(total > 0 ? sums[k] / total : static_cast<double>(k) / (angles - 1));
        if (j >= 3 && (total <= 1e-9 * c || c >= end)) break;
    }
}

double VisibleNormals::excess_area(double c) const {
    if (!(c < c_.back())) return 0;
    std::size_t i = 0;
    double low = 0, value_low = table_.tail(0).moment * 2, slope_low = -0.5;
    if (c >= c_[0]) {
        const double x = (std::log(c) - log_low_) / log_step_;
        const auto j = std::min(static_cast<std::size_t>(std::max(0.0, x)), c_.size() - 2);
        low = c_[j];
        value_low = excess_area_[j];
        slope_low = -above_[j];
        i = j + 1;
    }
    // Hermite's cubic; the derivative by c is -P(s_x > c).
    const double width = c_[i] - low, t = (c - low) / width;
    const double s = 1 - t;
    const double value = s * s * ((1 + 2 * t) * value_low + t * width * slope_low) +
                         t * t * ((3 - 2 * t) * excess_area_[i] + s * width * above_[i]);
    return std::max(0.0, value);
}

Slope<double> VisibleNormals::sample(const Uniform<double>& u) const {
    const double end = table_.nodes().back();
    const double r = table_.solve(1, 0, (1 - u.x) * table_.tail(0).area, 0, end);
    const double phi = 2 * pi * u.y;
    return {r * std::cos(phi), r * std::sin(phi)};
}

/// Lagrange weights of four rows at a cotangent.
struct VisibleNormals::Row {
    double cotangent, excess_area;
    std::size_t first;
    std::array<double, 4> weight;
};

VisibleNormals::Row VisibleNormals::row_at(double c) const {
    const double last = static_cast<double>(c_.size() - 1);
    const double x = c > c_[0] ? std::min(last, (std::log(c) - log_low_) / log_step_) : 0;
    const double first = std::clamp(std::floor(x) - 1, 0.0, last - 3);
    const double t = x - first, a = t - 1, b = t - 2, d = t - 3;
    return {c,
            excess_area(c),
            static_cast<std::size_t>(first),
            {-a * b * d / 6, t * b * d / 2, -t * a * d / 2, t * a * b / 6}};
}

/// The part of the visible area with |phi| below the k-th node.
double VisibleNormals::share(const Row& row, std::size_t k) const {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += row.weight[i] * share_[(row.first + i) * angles + k];
    return row.cotangent * static_cast<double>(k) / (angles - 1) + row.excess_area * sum;
}

Slope<double> VisibleNormals::sample_visible(const Direction<double>& v,
                                             const Uniform<double>& u) const {
    const double across = std::hypot(v.x, v.y);
    const double c = std::clamp(v.z / across, 0.0, 1e30);
    const Row row = row_at(c);

    // The line's angle to the view: Hermite's cubic through the table, with exact derivatives.
    const double wanted = std::abs(2 * u.x - 1) * (c + row.excess_area);
    std::size_t k = 0;
    for (std::size_t end = angles - 2; end > k;) {
        const std::size_t middle = (k + end + 1) / 2;
        if (share(row, middle) <= wanted)
            k = middle;
        else
            end = middle - 1;
    }
    const auto derivative = [&](std::size_t node) {
        const double cosine =
            node + 1 < angles ? std::cos(angle_step * static_cast<double>(node)) : 0;
        const double excess = cosine > 0 ? cosine * table_.excess(c / cosine) : 0;
        return angle_step * (2 / pi * c + 2 * excess);
    };
    const double p0 = share(row, k), rise = share(row, k + 1) - p0;
    const double d0 = derivative(k), d1 = derivative(k + 1);
    const double b = 3 * rise - 2 * d0 - d1, a = d0 + d1 - 2 * rise;
    const double t = find_root(0, 1, 0.5, [&](double x) {
        return std::pair(p0 - wanted + x * (d0 + x * (b + x * a)), d0 + x * (2 * b + 3 * a * x));
    });
    const double phi =
        std::copysign(std::min(pi / 2, angle_step * (static_cast<double>(k) + t)), u.x - 0.5);

    // The slope along the line, from the far end that faces the view to where it turns away.
    const double cosine = std::max(0.0, std::cos(phi)), tau = c / cosine;
    const double end = table_.nodes().back();
    const auto [area, moment] = table_.tail(0);
    const double back = c * area + cosine * moment;
    const double y = u.y * (2 * c * area + cosine * table_.excess(tau));
    const double slope = y < back
                             ? -table_.solve(c, cosine, y, 0, end)
                             : table_.solve(c, -cosine, 2 * c * area - y, 0, tau < end ? tau : end);
    const double x = slope * cosine, z = slope * std::sin(phi);
    const Slope<double> view =
        across > 0 ? Slope<double>{v.x / across, v.y / across} : Slope<double>{1, 0};
    return {view.x * x - view.y * z, view.y * x + view.x * z};
}

std::shared_ptr<const VisibleNormals> tabulated_normals(const std::function<double(double)>& p22) {
    return std::make_shared<const VisibleNormals>(RadialTable([&](const std::vector<double>& r) {
        std::vector<double> values(r.size());
        std::ranges::transform(r, values.begin(), p22);
        return values;
    }));
}

}  // namespace ltmd::inline v0
