// SPDX-License-Identifier: Apache-2.0
#include "ltmd/texel_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/threads.h"

namespace {

using namespace ltmd;

/// A mesh whose corners are all its own: only the UVs matter here.
struct Layout {
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> corner_vert;
    std::vector<Vec2f> corner_uv;

    void add(Vec2f a, Vec2f b, Vec2f c) {
        const auto first = static_cast<std::int32_t>(corner_uv.size());
        triangles.push_back({first, first + 1, first + 2});
        for (const Vec2f& uv : {a, b, c}) {
            corner_vert.push_back(static_cast<std::int32_t>(corner_uv.size()));
            corner_uv.push_back(uv);
        }
    }
    void add_quad(Vec2f low, Vec2f high) {
        add(low, {high[0], low[1]}, high);
        add(low, high, {low[0], high[1]});
    }
    MeshView view() const {
        return {triangles, corner_vert, corner_uv, static_cast<std::int32_t>(corner_vert.size())};
    }
};

/// An n x n grid of quads, bent so that no edge is straight or axis-aligned.
Layout bent_grid(int n, Vec2f low, float size) {
    Layout layout;
    const auto point = [&](int i, int j) {
        const float a = static_cast<float>(i) / static_cast<float>(n),
                    b = static_cast<float>(j) / static_cast<float>(n);
        return Vec2f{low[0] + size * (a + 0.11f * std::sin(5 * b)),
                     low[1] + size * (b + 0.13f * std::sin(4 * a))};
    };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            layout.add(point(i, j), point(i + 1, j), point(i + 1, j + 1));
            layout.add(point(i, j), point(i + 1, j + 1), point(i, j + 1));
        }
    return layout;
}

Layout random_triangles(int count, float size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-0.2f, 1.2f), offset(-size, size);
    Layout layout;
    for (int i = 0; i < count; ++i) {
        const Vec2f p = {place(random), place(random)};
        const auto near = [&] { return Vec2f{p[0] + offset(random), p[1] + offset(random)}; };
        const Vec2f a = near(), b = near(), c = near();
        layout.add(a, b, c);
    }
    return layout;
}

struct P {
    double x, y;
};

/// Independent model of one texel: every triangle, no bins, no shared work.
struct Model {
    std::vector<std::array<P, 3>> triangles;

    Model(const Layout& layout, int width, int height, Tile tile) {
        for (const Triangle& t : layout.triangles) {
            std::array<P, 3> p;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec2f& uv = layout.corner_uv[static_cast<std::size_t>(t[k])];
                p[k] = {(double(uv[0]) - tile.u) * width, (1 - (double(uv[1]) - tile.v)) * height};
            }
            triangles.push_back(p);
        }
    }
    static double cross(P a, P b, P c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    }

    /// > 0 inside, 0 on the border, < 0 outside.
    static double inside(const std::array<P, 3>& t, P p) {
        const double area = cross(t[0], t[1], t[2]);
        if (area == 0) return -1;
        const double s = area > 0 ? 1 : -1;
        return std::min(
            {s * cross(t[0], t[1], p), s * cross(t[1], t[2], p), s * cross(t[2], t[0], p)});
    }
    static double distance(const std::array<P, 3>& t, P p) {
        if (cross(t[0], t[1], t[2]) == 0) return std::numeric_limits<double>::infinity();
        if (inside(t, p) >= 0) return 0;
        double best = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < 3; ++k) {
            const P a = t[k], b = t[(k + 1) % 3];
            const double dx = b.x - a.x, dy = b.y - a.y;
            const double s =
                std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            best = std::min(best, std::hypot(p.x - a.x - s * dx, p.y - a.y - s * dy));
        }
        return best;
    }
    /// Area of the triangle's part in the unit square at (x, y), by clipping.
    static double area_in_square(const std::array<P, 3>& t, double x, double y) {
        std::vector<P> polygon(t.begin(), t.end());
        const auto clip = [&](auto&& height) {
            std::vector<P> result;
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const P a = polygon[i], b = polygon[(i + 1) % polygon.size()];
                const double ha = height(a), hb = height(b);
                if (ha >= 0) result.push_back(a);
                if ((ha >= 0) != (hb >= 0)) {
                    const double s = ha / (ha - hb);
                    result.push_back({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)});
                }
            }
            polygon = result;
        };
        clip([&](P p) { return p.x - x; });
        clip([&](P p) { return x + 1 - p.x; });
        clip([&](P p) { return p.y - y; });
        clip([&](P p) { return y + 1 - p.y; });
        double area = 0;
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
            area += cross(polygon[0], polygon[i], polygon[i + 1]);
        return std::abs(area) / 2;
    }
};

constexpr double texel_accuracy = 1e-9;  // of distances in texels

void expect_as_model(const Layout& layout, int width, int height, Tile tile, int margin) {
    const TexelCoverage coverage(layout.view(), width, height, tile, margin);
    const Model model(layout, width, height, tile);
    std::size_t covered = 0, overlapping = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            SCOPED_TRACE(testing::Message() << "texel " << x << ", " << y << " margin " << margin);
            const CoverageTexel texel =
                coverage.texels()[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(x)];
            const P centre = {x + 0.5, y + 0.5};
            int first = -1, strictly = 0;
            std::int32_t nearest = -1;
            double nearest_distance = std::numeric_limits<double>::infinity();
            bool met = false, near_tie = false;
            for (std::size_t i = 0; i < model.triangles.size(); ++i) {
                const double in = Model::inside(model.triangles[i], centre);
                if (in >= 0 && first < 0) first = static_cast<int>(i);
                strictly += in > 0;
                const double distance = Model::distance(model.triangles[i], centre);
                near_tie = near_tie || std::abs(distance - nearest_distance) < texel_accuracy;
                if (distance < nearest_distance - texel_accuracy) {
                    near_tie = false;
                    nearest = static_cast<std::int32_t>(i);
                    nearest_distance = distance;
                }
                if (margin == 0 && distance <= 0.7072)
                    met = met || Model::area_in_square(model.triangles[i], x, y) > 1e-12;
            }
            covered += first >= 0;
            overlapping += strictly > 1;
            if (first >= 0) {
                ASSERT_EQ(texel.triangle, first);
            } else if (std::abs(nearest_distance - margin) > texel_accuracy) {
                ASSERT_EQ(texel.triangle >= 0, margin == 0 ? met : nearest_distance <= margin)
                    << nearest_distance;
            }
            if (texel.triangle < 0) {
                ASSERT_EQ(texel.b0, 0);
                ASSERT_EQ(texel.b1, 0);
                continue;
            }
            // The lowest of equally near triangles: `nearest` is the first that reached the
            // distance.
            if (first < 0) {
                ASSERT_EQ(texel.triangle, nearest) << nearest_distance << " tie " << near_tie;
            }
            const auto& t = model.triangles[static_cast<std::size_t>(texel.triangle)];
            const double b0 = texel.b0, b1 = texel.b1, b2 = 1 - b0 - b1;
            ASSERT_GE(std::min({b0, b1, b2}), -1e-7);
            const P q = {b0 * t[0].x + b1 * t[1].x + b2 * t[2].x,
                         b0 * t[0].y + b1 * t[1].y + b2 * t[2].y};
            const double span = std::abs(t[0].x) + std::abs(t[1].x) + std::abs(t[2].x) +
                                std::abs(t[0].y) + std::abs(t[1].y) + std::abs(t[2].y);
            ASSERT_NEAR(std::hypot(q.x - centre.x, q.y - centre.y),
                        first >= 0 ? 0 : nearest_distance, 2e-7 * span);
        }
    EXPECT_EQ(coverage.covered(), covered);
    EXPECT_EQ(coverage.overlapping(), overlapping);
}

TEST(TexelCoverage, AgreesWithBruteForceOnABentChart) {
    for (const int margin : {0, 1, 5, 64})
        expect_as_model(bent_grid(6, {0.15f, 0.2f}, 0.6f), 150, 140, {}, margin);
}

TEST(TexelCoverage, AgreesWithBruteForceOnOverlappingTriangles) {
    for (const int margin : {0, 2, 16}) {
        expect_as_model(random_triangles(60, 0.06f, 1), 160, 131, {}, margin);
        expect_as_model(random_triangles(12, 0.9f, 2), 64, 64, {}, margin);
        expect_as_model(random_triangles(300, 0.01f, 3), 128, 200, {}, margin);
    }
}

TEST(TexelCoverage, TakesItsMarginFromTrianglesOfOtherTiles) {
    Layout layout;
    layout.add_quad({-0.5f, 0.25f}, {-0.03125f, 0.75f});
    expect_as_model(layout, 64, 64, {}, 8);
    const TexelCoverage coverage(layout.view(), 64, 64, {}, 8);
    EXPECT_EQ(coverage.covered(), 0u);
    EXPECT_GE(coverage.texels()[32 * 64].triangle, 0);
    EXPECT_LT(coverage.texels()[32 * 64 + 20].triangle, 0);
}

TEST(TexelCoverage, WorksInAnyTile) {
    for (const Tile tile : {Tile{-3, -2}, Tile{9, 99}, Tile{0, 1}}) {
        Layout layout = bent_grid(
            3, {static_cast<float>(tile.u) + 0.2f, static_cast<float>(tile.v) + 0.1f}, 0.6f);
        expect_as_model(layout, 50, 40, tile, 3);
        EXPECT_GT(TexelCoverage(layout.view(), 50, 40, tile, 3).covered(), 500u);
        EXPECT_EQ(TexelCoverage(layout.view(), 50, 40, {tile.u + 2, tile.v}, 3).covered(), 0u);
    }
}

TEST(TexelCoverage, RowZeroIsTheTop) {
    Layout layout;
    layout.add_quad({0, 0.75f}, {0.25f, 1});
    const TexelCoverage coverage(layout.view(), 4, 4, {}, 0);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(coverage.texels()[i].triangle >= 0, i == 0) << i;
}

TEST(TexelCoverage, CentresOnASharedEdgeAreNoOverlap) {
    Layout layout;
    layout.add_quad({0, 0}, {1, 1});  // the diagonal passes through centres
    const TexelCoverage coverage(layout.view(), 64, 64, {}, 0);
    EXPECT_EQ(coverage.covered(), 64u * 64u);
    EXPECT_EQ(coverage.overlapping(), 0u);
    for (std::size_t i = 0; i < 64; ++i)
        EXPECT_EQ(coverage.texels()[i * 64 + (63 - i)].triangle, 0);
    EXPECT_EQ(overlap_fraction(layout.view(), 64), 0);
}

TEST(TexelCoverage, SharedEdgesLeaveNoCrackAndNoOverlap) {
    // A whole turn of thin triangles around a point: each centre in exactly one, also where
    // rounding moves the edges by more than it moves the centres.
    for (const double radius : {0.9, 1e10}) {
        Layout layout;
        const auto rim = [&](int i) {
            const double a = 2 * std::numbers::pi * (i % 997) / 997;
            return Vec2f{static_cast<float>(0.5 + radius * std::cos(a)),
                         static_cast<float>(0.5 + radius * std::sin(a))};
        };
        for (int i = 0; i < 997; ++i) layout.add({0.4987f, 0.5013f}, rim(i), rim(i + 1));
        const TexelCoverage coverage(layout.view(), 300, 200, {}, 0);
        EXPECT_EQ(coverage.covered(), 300u * 200u);
        EXPECT_EQ(coverage.overlapping(), 0u);
    }
}

TEST(TexelCoverage, TheLowestOfEquallyNearTrianglesWins) {
    // Texel (32, 32): two texels from the border of triangle 1 and from a vertex that triangle 0
    // shares without a border edge there.
    const auto uv = [](float x, float y) { return Vec2f{(32.5f + x) / 64, 1 - (32.5f + y) / 64}; };
    Layout layout;
    layout.add(uv(2, 0), uv(10, -3), uv(10, 3));
    layout.add(uv(-2, -9), uv(-2, 9), uv(-9, 0));
    layout.add(uv(2, 0), uv(10, 3), uv(8, 9));
    layout.add(uv(2, 0), uv(8, -9), uv(10, -3));
    const TexelCoverage coverage(layout.view(), 64, 64, {}, 4);
    const CoverageTexel texel = coverage.texels()[32 * 64 + 32];
    EXPECT_EQ(texel.triangle, 0);
    EXPECT_EQ(texel.b0, 1);
    expect_as_model(layout, 64, 64, {}, 4);
}

TEST(TexelCoverage, CountsOverlap) {
    Layout layout;
    layout.add_quad({0, 0}, {0.5f, 0.5f});
    layout.add_quad({0.25f, 0}, {0.75f, 0.5f});
    layout.add_quad({0.25f, 0}, {0.5f, 0.5f});
    EXPECT_NEAR(overlap_fraction(layout.view(), 512), 1.0 / 3, 0.01);
    Layout moved = layout;
    for (Vec2f& uv : moved.corner_uv) uv[0] -= 4;
    EXPECT_EQ(overlap_fraction(moved.view(), 512), overlap_fraction(layout.view(), 512));
    EXPECT_EQ(overlap_fraction(Layout().view(), 64), 0);
}

TEST(TexelCoverage, TheLowestTriangleWins) {
    Layout layout;
    layout.add({0.1f, 0.1f}, {0.9f, 0.1f}, {0.5f, 0.9f});
    layout.add({0.1f, 0.1f}, {0.9f, 0.1f}, {0.5f, 0.9f});
    const TexelCoverage coverage(layout.view(), 64, 64, {}, 64);
    for (const CoverageTexel& texel : coverage.texels()) ASSERT_EQ(texel.triangle, 0);
    EXPECT_EQ(coverage.overlapping(), coverage.covered());
}

TEST(TexelCoverage, FacesInOnePlaceCostLittle) {
    // What resetting the UV map of a dense mesh gives: without care, minutes to hours.
    Layout layout;
    for (int i = 0; i < 100000; ++i) layout.add_quad({0.0625f, 0.0625f}, {0.9375f, 0.9375f});
    for (int i = 0; i < 1000; ++i)
        layout.add_quad({-0.001f * static_cast<float>(i), -1}, {1.1f, 2});
    const TexelCoverage coverage(layout.view(), 1024, 1024, {}, 16);
    EXPECT_EQ(coverage.covered(), 1024u * 1024u);
    EXPECT_EQ(coverage.overlapping(), 1024u * 1024u);
    for (std::size_t i = 0; i < coverage.texels().size(); ++i) {
        const std::size_t x = i % 1024, y = i / 1024;
        const bool in_first = x >= 64 && x < 960 && y >= 64 && y < 960;
        ASSERT_EQ(coverage.texels()[i].triangle / 2, in_first ? 0 : 100000) << x << " " << y;
    }
}

TEST(TexelCoverage, ATouchedTexelIsCoveredWithoutMargin) {
    Layout layout;
    layout.add({0.02f, 0.02f}, {0.05f, 0.02f}, {0.02f, 0.05f});  // inside one texel, off its centre
    const TexelCoverage coverage(layout.view(), 8, 8, {}, 0);
    EXPECT_EQ(coverage.covered(), 0u);
    for (std::size_t i = 0; i < 64; ++i)
        EXPECT_EQ(coverage.texels()[i].triangle >= 0, i == 56) << i;
}

TEST(TexelCoverage, TrianglesWithoutAreaCoverNothing) {
    Layout layout;
    layout.add({0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f});
    layout.add({0.1f, 0.1f}, {0.5f, 0.5f}, {0.9f, 0.9f});
    const TexelCoverage coverage(layout.view(), 32, 32, {}, 8);
    for (const CoverageTexel& texel : coverage.texels()) ASSERT_EQ(texel.triangle, -1);
    layout.add_quad({0.25f, 0.25f}, {0.75f, 0.75f});
    const TexelCoverage with_quad(layout.view(), 32, 32, {}, 8);
    for (const CoverageTexel& texel : with_quad.texels())
        ASSERT_TRUE(texel.triangle < 0 || texel.triangle >= 2);
}

TEST(TexelCoverage, HugeTrianglesAreClipped) {
    for (const float far : {3.0f, 1e6f, 1e20f, 3e38f}) {
        Layout layout;
        layout.add({-far, -far}, {far, -far}, {0, far});
        const TexelCoverage coverage(layout.view(), 200, 70, {}, 16);
        EXPECT_EQ(coverage.covered(), 200u * 70u) << far;
        for (const CoverageTexel& texel : coverage.texels()) {
            ASSERT_EQ(texel.triangle, 0);
            ASSERT_TRUE(texel.b0 >= 0 && texel.b1 >= 0 && texel.b0 + texel.b1 <= 1.000001f);
        }
        Layout outside;
        outside.add({2, 2}, {far, 2}, {far, far});
        EXPECT_EQ(TexelCoverage(outside.view(), 200, 70, {}, 16).covered(), 0u);
    }
}

TEST(TexelCoverage, SmallestAndEmpty) {
    Layout layout;
    layout.add_quad({0, 0}, {1, 1});
    const TexelCoverage one(layout.view(), 1, 1, {}, 0);
    ASSERT_EQ(one.texels().size(), 1u);
    EXPECT_EQ(one.texels()[0].triangle, 0);
    EXPECT_FLOAT_EQ(one.texels()[0].b0, 0.5f);
    EXPECT_EQ(one.texels()[0].b1, 0.0f);

    const TexelCoverage empty(Layout().view(), 3, 5, {}, 16);
    ASSERT_EQ(empty.texels().size(), 15u);
    for (const CoverageTexel& texel : empty.texels()) EXPECT_EQ(texel.triangle, -1);
}

TEST(TexelCoverage, HasTheSameBitsForAnyThreadCount) {
    const Layout layout = random_triangles(500, 0.05f, 5);
    set_thread_count(1);
    const TexelCoverage one(layout.view(), 700, 500, {}, 7);
    for (const int threads : {2, 3, 8}) {
        set_thread_count(threads);
        const TexelCoverage many(layout.view(), 700, 500, {}, 7);
        EXPECT_EQ(std::memcmp(one.texels().data(), many.texels().data(), one.texels().size_bytes()),
                  0)
            << threads;
        EXPECT_EQ(one.covered(), many.covered());
        EXPECT_EQ(one.overlapping(), many.overlapping());
    }
    set_thread_count(0);
}

TEST(TexelCoverage, RefusesWhatItCannotDo) {
    Layout layout;
    layout.add_quad({0, 0}, {1, 1});
    for (const auto& [width, height, margin] :
         {std::array{0, 4, 1}, {4, 0, 1}, {-1, 4, 1}, {65537, 4, 1}, {4, 4, -1}, {4, 4, 65}})
        EXPECT_THROW(TexelCoverage(layout.view(), width, height, {}, margin), InvalidInput);
    MeshView no_uv = layout.view();
    no_uv.corner_uv = {};
    EXPECT_THROW(TexelCoverage(no_uv, 4, 4), InvalidInput);
    EXPECT_THROW(overlap_fraction(no_uv), InvalidInput);
    EXPECT_THROW(overlap_fraction(layout.view(), 0), InvalidInput);
}

}  // namespace
