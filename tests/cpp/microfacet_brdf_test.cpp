// SPDX-License-Identifier: Apache-2.0
#include "ltmd/microfacet_brdf.h"

#include <gtest/gtest.h>

#include "ltmd/errors.h"
#include "ltmd/ggx.h"

namespace {

using ltmd::Direction;
using ltmd::GGX;
using ltmd::MaskingModel;

constexpr double eps = std::numeric_limits<double>::epsilon();
const Direction<double> a = normalized(Direction<double>{0.3, 0.2, 0.5});
const Direction<double> b = normalized(Direction<double>{-0.7, 0.1, 0.4});

TEST(MicrofacetBrdf, IsReciprocalWithAnyFunctionAsFresnel) {
    const auto d = transformed(GGX<double>(0.4), ltmd::Matrix2{1, 0.5, 0, 2});
    const auto schlick = [](double c) { return ltmd::fresnel_schlick(c, 0.1); };
    const double forth = brdf(d, a, b, schlick), back = brdf(d, b, a, schlick);
    EXPECT_GT(forth, 0);
    EXPECT_NEAR(forth, back, 100 * eps * forth);
}

TEST(MicrofacetBrdf, MirrorDirectionOfASmoothSurface) {
    // At h = n: D = 1 / (pi alpha^2), and masking is all but gone.
    const GGX<double> d(1e-4);
    const Direction<double> mirrored{-a.x, -a.y, a.z};
    const double peak = brdf(d, a, mirrored, [](double) { return 1.; });
    const double expected = std::numbers::inv_pi * 1e8 / (4 * a.z * a.z);
    EXPECT_NEAR(peak, expected, 1e-7 * expected);
}

TEST(MicrofacetBrdf, ArraysAreTheScalarsItemByItem) {
    const GGX<float> d(0.3F);
    const std::vector<Direction<float>> wi(5000, {0.6F, 0, 0.8F}), wo(5000, {0, 0.28F, -0.96F});
    std::vector<float> out(5000);
    const ltmd::AnyDistribution<float> any(d);
    ltmd::btdf<float>(any, wi, wo, 1.5F, MaskingModel::separable, out);
    const float expected = btdf(d, wi[0], wo[0], 1.5F, MaskingModel::separable);
    EXPECT_GT(expected, 0);
    for (const float value : out) EXPECT_EQ(value, expected);
    out.pop_back();
    EXPECT_THROW(ltmd::brdf<float>(any, wi, wo, MaskingModel::separable, out), ltmd::InvalidInput);
}

TEST(BetaFunction, KnownValues) {
    EXPECT_NEAR(ltmd::beta_function(1, 1), 1, 20 * eps);
    EXPECT_NEAR(ltmd::beta_function(2, 3), 1. / 12, 20 * eps / 12);
    EXPECT_NEAR(ltmd::beta_function(1, 1e6), 1e-6, 1e-18);
    EXPECT_NEAR(ltmd::beta_function(1, 1e30), 1e-30, 1e-42);
    EXPECT_EQ(ltmd::beta_function(1e30, 1e30), 0);
}

}  // namespace
