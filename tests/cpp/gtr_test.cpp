// SPDX-License-Identifier: Apache-2.0
#include "ltmd/gtr.h"

#include <gtest/gtest.h>

#include "ltmd/errors.h"
#include "ltmd/ggx.h"
#include "ltmd/transformed_distribution.h"

namespace {

using ltmd::Direction;
using ltmd::GGX;
using ltmd::GTR;
using ltmd::GTRMasking;

template <class Real>
std::vector<Direction<Real>> directions() {
    std::vector<Direction<Real>> all{{0, 0, 1}};
    for (double degrees : {1e-3, 0.1, 1.0, 10.0, 45.0, 80.0, 89.0, 89.99}) {
        const double theta = degrees * std::numbers::pi / 180;
        all.push_back({static_cast<Real>(std::sin(theta) * 0.6),
                       static_cast<Real>(std::sin(theta) * 0.8),
                       static_cast<Real>(std::cos(theta))});
    }
    return all;
}

constexpr double alphas[] = {1e-4, 1e-3, 0.01, 0.04, 0.1, 0.3, 0.6, 0.9, 0.999, 1 - 1e-9, 1};
constexpr double gammas[] = {0, 1e-9,  0.01, 0.5, 0.999, 1 - 1e-9, 1,   1 + 1e-9, 1.4, 1.999999,
                             2, 2.001, 2.2,  2.7, 3,     3.001,    3.5, 3.999,    4};

TEST(Gtr, IsADistribution) {
    static_assert(ltmd::MicrofacetDistribution<GTR<float>>);
    static_assert(ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<GTR<double>>>);
}

TEST(Gtr, GammaTwoIsGgx) {
    for (const double alpha : alphas) {
        const GTR<double> gtr(alpha, 2);
        const GGX<double> ggx(alpha);
        for (const auto& d : directions<double>()) {
            EXPECT_NEAR(gtr.D(d), ggx.D(d), 1e-12 * ggx.D(d));
            EXPECT_NEAR(gtr.P22({d.x, d.y}), ggx.P22({d.x, d.y}), 1e-12 * ggx.P22({d.x, d.y}));
            EXPECT_NEAR(gtr.Lambda(d), ggx.Lambda(d), 1e-12 * ggx.Lambda(d));
            EXPECT_NEAR(gtr.projected_area(d), ggx.projected_area(d), 1e-12);
        }
    }
}

TEST(Gtr, AlphaOneIsGgxOfAlphaOne) {
    const GGX<double> ggx(1);
    for (const double gamma : gammas)
        for (const double alpha : {1.0, 1 - 1e-14})
            for (const auto& d : directions<double>()) {
                const GTR<double> gtr(alpha, gamma);
                EXPECT_NEAR(gtr.D(d), ggx.D(d), 1e-12 * ggx.D(d));
                EXPECT_NEAR(gtr.Lambda(d), ggx.Lambda(d), 1e-12 * ggx.Lambda(d));
                for (const double u : {0.0, 0.3, 1.0})
                    EXPECT_NEAR(gtr.sample({u, 0.2}).z, ggx.sample({u, 0.2}).z, 1e-7);
            }
}

// The weights are positive and sum to 1.
TEST(Gtr, IsAPositiveMixture) {
    for (const double alpha : alphas)
        for (const double gamma : gammas) {
            const auto lobes = ltmd::gtr_lobes(alpha, gamma, 40);
            double sum = 0;
            for (std::size_t i = 0; i < lobes.count; ++i)
                for (const auto& weights : lobes.weight) {
                    EXPECT_GE(weights[i], 0);
                    sum += weights[i];
                }
            EXPECT_NEAR(sum, 1, 1e-14);
        }
}

TEST(Gtr, SinglePrecisionIsNearDouble) {
    double worst_lambda = 0, worst_area = 0, worst_d = 0, worst_g1_spline = 0;
    for (const double alpha : alphas)
        for (const double gamma : gammas) {
            const GTR<double> full(alpha, gamma);
            const GTR<float> single(alpha, gamma);
            for (const auto& f : directions<float>()) {
                const Direction<double> d{f.x, f.y, f.z};
                for (const float value : {single.D(f), single.Lambda(f), single.G1(f)}) {
                    EXPECT_TRUE(std::isfinite(value)) << alpha << " " << gamma;
                    EXPECT_GE(value, 0);
                }
                EXPECT_LE(single.G1(f), 1);
                const auto relative = [](double a, double b) { return std::abs(a / b - 1); };
                if (d.x > 0)
                    worst_lambda =
                        std::max(worst_lambda, relative(single.Lambda(f), full.Lambda(d)));
                worst_area = std::max(worst_area,
                                      relative(single.projected_area(f), full.projected_area(d)));
                worst_d = std::max(worst_d, relative(single.D(f), full.D(d)));
                const auto spline = [&](auto real) {
                    return GTR<decltype(real)>(alpha, gamma, GTRMasking::spline);
                };
                worst_g1_spline = std::max<double>(worst_g1_spline,
                                                   std::abs(spline(1.f).G1(f) - spline(1.).G1(d)));
            }
        }
    constexpr double eps = std::numeric_limits<float>::epsilon();
    EXPECT_LT(worst_lambda, 12 * eps);
    EXPECT_LT(worst_area, 4 * eps);
    // Of the exponent gamma and of alpha^2 to the power gamma.
    EXPECT_LT(worst_d, 16 * eps);
    EXPECT_LT(worst_g1_spline, 4 * eps);
}

TEST(Gtr, RefusesWhatIsOutOfRange) {
    for (const double alpha : {0.0, 9e-5, 1.0001, -0.1, std::nan("")})
        EXPECT_THROW(GTR<float>(alpha, 1), ltmd::InvalidInput);
    for (const double gamma : {-1e-9, 4.0001, std::nan("")})
        EXPECT_THROW(GTR<double>(0.1, gamma), ltmd::InvalidInput);
}

}  // namespace
