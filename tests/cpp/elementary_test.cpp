// SPDX-License-Identifier: Apache-2.0
#include "ltmd/elementary.h"

#include <gtest/gtest.h>

#include <random>

namespace {

namespace elementary = ltmd::elementary;

constexpr double eps = std::numeric_limits<float>::epsilon();
constexpr int count = 200000;

/// The greatest relative error in units of epsilon over x = draw(u).
template <class Draw, class Single, class Exact>
double greatest_error(const Draw& draw, const Single& single, const Exact& exact) {
    std::mt19937 random(0);
    std::uniform_real_distribution<float> uniform(0, 1);
    double greatest = 0;
    for (int i = 0; i < count; ++i) {
        const float x = draw(uniform(random));
        const double expected = exact(static_cast<double>(x));
        if (expected != 0) greatest = std::max(greatest, std::abs(single(x) / expected - 1) / eps);
    }
    return greatest;
}

TEST(Elementary, IsAsAccurateInFloatAsStated) {
    const auto positive = [](float u) { return std::exp(87 * (2 * u - 1)); };
    const auto around_1 = [](float u) { return 0.5F + u; };
    EXPECT_LT(greatest_error([](float u) { return 87 * (2 * u - 1); },
                             [](float x) { return elementary::exp(x); },
                             [](double x) { return std::exp(x); }),
              1);
    for (const bool near : {false, true})
        EXPECT_LT(greatest_error([&](float u) { return near ? around_1(u) : positive(u); },
                                 [](float x) { return elementary::log(x); },
                                 [](double x) { return std::log(x); }),
                  2);
    EXPECT_LT(greatest_error(
                  positive, [](float x) { return elementary::log1p(x); },
                  [](double x) { return std::log1p(x); }),
              3);
    for (const bool near : {false, true})
        EXPECT_LT(greatest_error(
                      [&](float u) { return near ? std::exp(-14 * u) - 1 : -std::exp(-40 * u); },
                      [](float x) { return elementary::log1p(x); },
                      [](double x) { return std::log1p(x); }),
                  3);
    for (const float y : {0.0F, 0.3F, 1.4F, -2.0F, 3.999F, -4.0F, 4.7F})
        for (const bool near : {false, true}) {
            const float most = 86 / std::max(1.0F, std::abs(y));
            EXPECT_LT(
                greatest_error(
                    [&](float u) { return near ? around_1(u) : std::exp(most * (2 * u - 1)); },
                    [&](float x) { return elementary::pow(x, y); },
                    [&](double x) { return std::pow(x, static_cast<double>(y)); }),
                1 + 2 * std::abs(y))
                << y;
        }
    EXPECT_LT(greatest_error([](float u) { return std::exp(44 * u - 40); },
                             [](float x) { return elementary::expm1(x); },
                             [](double x) { return std::expm1(x); }),
              3);
}

TEST(Elementary, TurnsByAShareOfTheCircle) {
    for (int i = 0; i <= 1000; ++i) {
        const float u = static_cast<float>(i) / 1000;
        const double phi = 2 * std::numbers::pi * static_cast<double>(u);
        EXPECT_NEAR(elementary::turn(u).cos, std::cos(phi), eps) << u;
        EXPECT_NEAR(elementary::turn(u).sin, std::sin(phi), eps) << u;
    }
    EXPECT_EQ(elementary::turn(0.25F).cos, 0);
    EXPECT_EQ(elementary::turn(0.25F).sin, 1);
    EXPECT_EQ(elementary::turn(1.0F).cos, 1);
}

TEST(Elementary, StaysFiniteAtTheEnds) {
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(elementary::exp(-infinity), 0);
    EXPECT_EQ(elementary::exp(-88.0F), 0);
    EXPECT_EQ(elementary::exp(0.0F), 1);
    EXPECT_EQ(elementary::log(1.0F), 0);
    EXPECT_EQ(elementary::pow(1.0F, 4.0F), 1);
    EXPECT_EQ(elementary::pow(7.0F, 0.0F), 1);
    EXPECT_EQ(elementary::pow(1e30F, -4.0F), 0);
    EXPECT_EQ(elementary::pow(1e30F, 4.0F), infinity);
    EXPECT_NEAR(elementary::log(0.0F), -87.3365, 1e-4);
    EXPECT_NEAR(elementary::log1p(infinity), 88.7228, 1e-4);
}

}  // namespace
