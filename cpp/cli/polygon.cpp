// SPDX-License-Identifier: Apache-2.0
#include "polygon.h"

#include <cmath>
#include <numeric>

namespace ltmd::cli {
namespace {

using Vec2d = std::array<double, 2>;

/// The polygon without the axis that its normal is closest to, turned counter-clockwise.
std::vector<Vec2d> projected(std::span<const Vec3f> corners) {
    std::array<double, 3> normal = {};
    // Newell's sum, about the first corner: large coordinates would cancel.
    const auto relative = [&](std::size_t i, std::size_t axis) {
        return static_cast<double>(corners[i % corners.size()][axis]) - corners[0][axis];
    };
    for (std::size_t i = 0; i < corners.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
            normal[axis] +=
                relative(i, a) * relative(i + 1, b) - relative(i, b) * relative(i + 1, a);
        }
    std::size_t drop = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
        if (std::abs(normal[axis]) > std::abs(normal[drop])) drop = axis;
    std::size_t a = (drop + 1) % 3, b = (drop + 2) % 3;
    if (normal[drop] < 0) std::swap(a, b);
    std::vector<Vec2d> flat;
    for (std::size_t i = 0; i < corners.size(); ++i)
        flat.push_back({relative(i, a), relative(i, b)});
    return flat;
}

/// Twice the signed area.
double area(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool contains(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& p) {
    return p != a && p != b && p != c && area(a, b, p) >= 0 && area(b, c, p) >= 0 &&
           area(c, a, p) >= 0;
}

double squared_distance(const Vec3f& a, const Vec3f& b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double d = static_cast<double>(b[axis]) - a[axis];
        sum += d * d;
    }
    return sum;
}

}  // namespace

void cut_polygon(std::span<const Vec3f> corners, std::vector<std::array<std::size_t, 3>>& out) {
    if (corners.size() == 3) {
        out.push_back({0, 1, 2});
        return;
    }
    const std::vector<Vec2d> p = projected(corners);
    if (corners.size() == 4) {
        const bool can_join_02 = area(p[0], p[1], p[2]) > 0 && area(p[0], p[2], p[3]) > 0;
        const bool can_join_13 = area(p[0], p[1], p[3]) > 0 && area(p[1], p[2], p[3]) > 0;
        const bool is_02_shorter =
            squared_distance(corners[0], corners[2]) < squared_distance(corners[1], corners[3]);
        if (can_join_02 && (is_02_shorter || !can_join_13))
            out.insert(out.end(), {{0, 1, 2}, {0, 2, 3}});
        else
            out.insert(out.end(), {{0, 1, 3}, {1, 2, 3}});
        return;
    }
    std::vector<std::size_t> left(corners.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    while (left.size() > 3) {
        const std::size_t n = left.size();
        std::size_t ear = 0;
        double largest = -1;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
            const double size = area(p[a], p[b], p[c]);
            // Without an ear, as in a polygon that crosses itself, the first corner goes.
            if (size <= largest || size < 0) continue;
            bool is_free = true;
            for (const std::size_t other : left)
                is_free = is_free && !contains(p[a], p[b], p[c], p[other]);
            if (!is_free) continue;
            ear = i;
            largest = size;
            if (size > 0) break;
        }
        out.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    out.push_back({left[0], left[1], left[2]});
}

}  // namespace ltmd::cli
