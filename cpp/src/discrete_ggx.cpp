// SPDX-License-Identifier: Apache-2.0
#include "ltmd/discrete_ggx.h"

#include <array>
#include <random>

#include "find_root.h"
#include "ltmd/errors.h"
#include "text.h"

namespace ltmd::inline v0 {
namespace {

using std::numbers::pi;

constexpr std::uint32_t leaf_size = 8;

/// Uniform in [0, 1), the same on every platform.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// The integral of sqrt(s^2 - y^2) from 0 to y.
double segment(double s, double y) {
    return (y * std::sqrt(std::max(0.0, s * s - y * y)) + s * s * std::asin(std::min(1.0, y / s))) /
           2;
}

}  // namespace

/// A view and its frame's use for a cap: all lengths are of the cap's orthogonal projection along
/// the view, x towards the cap's axis. The cap's rim is an ellipse around (cosine_ sin(angle), 0)
/// with half-axes sine_ cos(angle), sine_; where the cap turns away the unit circle bounds it.
struct DiscreteFacets::View {
    Direction<double> v;

    /// One side (y >= 0) of the visible part of a cap that is partly turned away: the unit circle
    /// is its outline up to y = turned, the ellipse alone from there to y = end.
    struct Part {
        double sine_angle, cosine_angle, sine, cosine;
        double turned, end;

        Part(double cosine_of_angle, double s, double c)
            : sine_angle(std::sqrt((1 - cosine_of_angle) * (1 + cosine_of_angle))),
              cosine_angle(cosine_of_angle),
              sine(s),
              cosine(c),
              turned(std::sqrt(
                  std::max(0.0, (sine_angle - c) * (sine_angle + c) / (sine_angle * sine_angle)))),
              end(cosine_of_angle > 0 ? s : turned) {}

        /// The area below y.
        double area(double y) const {
            const double low = std::min(y, turned);
            double sum =
                segment(1, low) - cosine * sine_angle * low + cosine_angle * segment(sine, low);
            if (y > turned) sum += 2 * cosine_angle * (segment(sine, y) - segment(sine, turned));
            return sum;
        }
        std::pair<double, double> ends(double y) const {
            const double half = cosine_angle * std::sqrt(std::max(0.0, sine * sine - y * y));
            const double middle = cosine * sine_angle;
            return {middle - half, y < turned ? std::sqrt(1 - y * y) : middle + half};
        }
    };
};

DiscreteFacets::DiscreteFacets(double alpha, double facets, double cone, std::uint64_t seed) {
    require_range("alpha", alpha, smallest_alpha, largest_alpha);
    require_range("facets", facets, 1, 1e7);
    if (facets != std::floor(facets))
        throw InvalidInput(text("facets is ", facets, "; it must be a whole number"));
    require_range("cone", cone, 1e-3, 1);
    sine_ = std::sin(cone);
    cosine_ = std::cos(cone);
    chord_ = 2 * std::sin(cone / 2);

    // GGX's tan^2 = alpha^2 x / (1 - x) for uniform x, as far as the cap stays above the horizon.
    std::mt19937_64 random(seed);
    const double reach = cosine_ / (sine_ * alpha);
    const double share = reach * reach / (1 + reach * reach);
    normals_.reserve(static_cast<std::size_t>(facets));
    for (double i = 0; i < facets; ++i) {
        const double x = share * uniform(random), phi = 2 * pi * uniform(random);
        const double r = alpha * std::sqrt(x / (1 - x));
        normals_.push_back(normalized(Direction<double>{r * std::cos(phi), r * std::sin(phi), 1}));
    }
    build(0, static_cast<std::uint32_t>(normals_.size()));
}

std::uint32_t DiscreteFacets::build(std::uint32_t begin, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node{{0, 0, 0}, 0, 0, {0, 0, 0}, begin, end, 0};
    Direction<double> low{2, 2, 2}, high{-2, -2, -2};
    const double count = static_cast<double>(normals_.size());
    for (std::uint32_t i = begin; i < end; ++i) {
        const Direction<double>& n = normals_[i];
        low = {std::min(low.x, n.x), std::min(low.y, n.y), std::min(low.z, n.z)};
        high = {std::max(high.x, n.x), std::max(high.y, n.y), std::max(high.z, n.z)};
        node.density += density_of(n);
        const double scale = 1 / (n.z * count);
        node.projected.x += n.x * scale;
        node.projected.y += n.y * scale;
        node.projected.z += n.z * scale;
    }
    node.centre = {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
    for (std::uint32_t i = begin; i < end; ++i) {
        const Direction<double>& n = normals_[i];
        node.radius =
            std::max(node.radius, length(Direction<double>{n.x - node.centre.x, n.y - node.centre.y,
                                                           n.z - node.centre.z}));
    }
    nodes_.push_back(node);
    if (end - begin > leaf_size) {
        const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
        const auto widest = x >= y && x >= z ? &Direction<double>::x
                            : y >= z         ? &Direction<double>::y
                                             : &Direction<double>::z;
        const std::uint32_t middle = begin + (end - begin) / 2;
        std::ranges::nth_element(normals_.begin() + begin, normals_.begin() + middle,
                                 normals_.begin() + end, {}, widest);
        build(begin, middle);
        nodes_[index].second = build(middle, end);
    }
    return index;
}

/// D inside one cap: its share of the projected area over that of the whole cap.
double DiscreteFacets::density_of(const Direction<double>& normal) const {
    return 1 / (pi * sine_ * sine_ * normal.z * static_cast<double>(normals_.size()));
}

double DiscreteFacets::D(const Direction<double>& m) const {
    if (!(m.z > 0)) return 0;
    const auto distance = [&](const Direction<double>& c) {
        return length(Direction<double>{m.x - c.x, m.y - c.y, m.z - c.z});
    };
    double sum = 0;
    std::array<std::uint32_t, 64> stack{0};
    for (std::size_t size = 1; size > 0;) {
        const std::uint32_t index = stack[--size];
        const Node& node = nodes_[index];
        const double d = distance(node.centre);
        if (d > chord_ + node.radius) continue;
        if (d + node.radius < chord_) {
            sum += node.density;
        } else if (node.second == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                if (distance(normals_[i]) <= chord_) sum += density_of(normals_[i]);
        } else {
            stack[size++] = index + 1;
            stack[size++] = node.second;
        }
    }
    return sum;
}

double DiscreteFacets::facet_area(const View& view, std::uint32_t facet) const {
    const Direction<double>& n = normals_[facet];
    const double cosine = dot(n, view.v);
    if (cosine <= -sine_) return 0;
    const double weight = density_of(n);
    if (cosine >= sine_) return weight * pi * sine_ * sine_ * cosine;
    const View::Part part(cosine, sine_, cosine_);
    return weight * 2 * std::max(0.0, part.area(part.end));
}

double DiscreteFacets::area(const View& view, std::uint32_t index) const {
    const Node& node = nodes_[index];
    const double middle = dot(node.centre, view.v);
    if (middle - node.radius >= sine_) return dot(node.projected, view.v);
    if (middle + node.radius <= -sine_) return 0;
    if (node.second == 0) {
        double sum = 0;
        for (std::uint32_t i = node.begin; i < node.end; ++i) sum += facet_area(view, i);
        return sum;
    }
    return area(view, index + 1) + area(view, node.second);
}

double DiscreteFacets::projected_area(const Direction<double>& v) const { return area(View{v}, 0); }

Direction<double> DiscreteFacets::sample(const Uniform<double>& u) const {
    // Along the macrosurface's normal all facets have one projected area.
    const double scaled = u.x * static_cast<double>(normals_.size());
    const auto facet = std::min(static_cast<std::size_t>(scaled), normals_.size() - 1);
    return sample_cap(View{{0, 0, 1}}, normals_[facet], {scaled - static_cast<double>(facet), u.y});
}

Direction<double> DiscreteFacets::sample_visible(const Direction<double>& v,
                                                 const Uniform<double>& u) const {
    const View view{v};
    double target = u.x * area(view, 0);
    std::uint32_t index = 0;
    while (nodes_[index].second != 0) {
        const double first = area(view, index + 1);
        if (target < first) {
            ++index;
        } else {
            target -= first;
            index = nodes_[index].second;
        }
    }
    // The facet; rounding may leave no area at the end, so remember the last that has some.
    const Node& leaf = nodes_[index];
    std::uint32_t facet = leaf.begin;
    double rest = 0, whole = 0;
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
        const double here = facet_area(view, i);
        if (here > 0) {
            facet = i;
            rest = target;
            whole = here;
            if (target < here) break;
            target -= here;
        }
    }
    const double left = whole > 0 ? std::clamp(rest / whole, 0.0, 1.0) : 0.5;
    return sample_cap(view, normals_[facet], {left, u.y});
}

/// Uniform in the projection of the cap's visible part along the view.
Direction<double> DiscreteFacets::sample_cap(const View& view, const Direction<double>& normal,
                                             const Uniform<double>& u) const {
    const Direction<double>& v = view.v;
    const double cosine = std::clamp(dot(normal, v), -1.0, 1.0);
    // The part of the normal across the view, or any direction across it.
    Direction<double> across{normal.x - cosine * v.x, normal.y - cosine * v.y,
                             normal.z - cosine * v.z};
    if (!(length(across) > 1e-9))
        across =
            std::abs(v.z) < 0.9 ? Direction<double>{v.y, -v.x, 0} : Direction<double>{0, v.z, -v.y};
    const Direction<double> a = normalized(across);
    const Direction<double> b{v.y * a.z - v.z * a.y, v.z * a.x - v.x * a.z, v.x * a.y - v.y * a.x};

    double x, y;
    if (cosine >= sine_) {
        const double radius = std::sqrt(u.x), phi = 2 * pi * u.y;
        x = cosine_ * std::sqrt((1 - cosine) * (1 + cosine)) +
            sine_ * cosine * radius * std::cos(phi);
        y = sine_ * radius * std::sin(phi);
    } else {
        const View::Part part(cosine, sine_, cosine_);
        const double wanted = std::abs(2 * u.x - 1) * part.area(part.end);
        const double at = find_root(0, part.end, part.end / 2, [&](double t) {
            const auto [low, high] = part.ends(t);
            return std::pair(part.area(t) - wanted, high - low);
        });
        const auto [low, high] = part.ends(at);
        x = std::lerp(low, high, u.y);
        y = std::copysign(at, u.x - 0.5);
    }
    const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));
    return normalized(Direction<double>{x * a.x + y * b.x + z * v.x, x * a.y + y * b.y + z * v.y,
                                        x * a.z + y * b.z + z * v.z});
}

template AnyDistribution<float>::AnyDistribution(DiscreteGGX<float>);
template AnyDistribution<double>::AnyDistribution(DiscreteGGX<double>);

}  // namespace ltmd::inline v0
