// SPDX-License-Identifier: Apache-2.0
#include "ltmd/discrete_ggx.h"

#include <gtest/gtest.h>

#include "ltmd/errors.h"
#include "ltmd/transformed_distribution.h"

namespace {

using ltmd::Direction;
using ltmd::DiscreteGGX;

static_assert(ltmd::MicrofacetDistribution<DiscreteGGX<float>>);
static_assert(ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<DiscreteGGX<double>>>);

TEST(DiscreteGgx, AllCapsAreOfOneProjectedArea) {
    const DiscreteGGX<double> d(0.3, 500, 0.02, 1);
    EXPECT_NEAR(d.projected_area({0, 0, 1}), 1, 1e-12);
    EXPECT_EQ(d.facets().normals().size(), 500u);
}

TEST(DiscreteGgx, SamplesLieInCapsThatTheViewSees) {
    const DiscreteGGX<double> d(0.3, 500, 0.02, 1);
    const Direction<double> v = normalized(Direction<double>{0.9, -0.3, 0.1});
    for (int i = 0; i < 1000; ++i) {
        const ltmd::Uniform<double> u{(i + 0.5) / 1000, std::fmod(0.6180339887498949 * i, 1.0)};
        const Direction<double> m = d.sample_visible(v, u);
        EXPECT_GT(d.D(m), 0);
        EXPECT_GT(dot(m, v), 0);
        EXPECT_GT(d.D(d.sample(u)), 0);
    }
}

TEST(DiscreteGgx, AViewOfNoFacetHasAnAnswer) {
    // The only facet faces away.
    const DiscreteGGX<double> d(1, 1, 1e-3, 0);
    const Direction<double> n = d.facets().normals()[0];
    const Direction<double> v = normalized(Direction<double>{-n.x, -n.y, 1e-6});
    EXPECT_EQ(d.projected_area(v), 0);
    EXPECT_EQ(d.Lambda(v), 0);
    EXPECT_TRUE(std::isfinite(d.sample_visible(v, {0.5, 0.5}).x));
}

TEST(DiscreteGgx, RefusesWhatIsOutOfRange) {
    EXPECT_THROW(DiscreteGGX<float>(0, 10, 0.1, 0), ltmd::InvalidInput);
    EXPECT_THROW(DiscreteGGX<float>(0.3, 10.5, 0.1, 0), ltmd::InvalidInput);
    EXPECT_THROW(DiscreteGGX<float>(0.3, 10, 2, 0), ltmd::InvalidInput);
}

}  // namespace
