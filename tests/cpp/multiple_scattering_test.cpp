// SPDX-License-Identifier: Apache-2.0
#include "ltmd/multiple_scattering.h"

#include <gtest/gtest.h>

#include "ltmd/diffuse_microfacets.h"
#include "ltmd/ggx.h"
#include "ltmd/height_masking.h"

namespace {

using ltmd::Direction;
using ltmd::GGX;

const Direction<double> up{0, 0, 1};
const Direction<double> grazing = normalized(Direction<double>{1, 0, 0.1});

TEST(MultipleScattering, RougherSurfacesScatterMore) {
    double before = 0;
    for (const double alpha : {0.1, 0.4, 0.8}) {
        const ltmd::MultipleScattering rest(GGX<double>{alpha});
        EXPECT_GT(rest.mean_energy(), before);
        EXPECT_NEAR(rest.energy(grazing), 1 - single_scattering_albedo(GGX<double>(alpha), grazing),
                    1e-15);
        EXPECT_DOUBLE_EQ(rest.brdf(up, grazing), rest.brdf(grazing, up));
        before = rest.mean_energy();
    }
}

TEST(MultipleScattering, AverageOfAConstantFresnelIsTheConstant) {
    const auto constant = [](double) { return 0.25; };
    EXPECT_NEAR(average_visible_fresnel(GGX<double>(0.5), grazing, constant), 0.25, 1e-15);
}

TEST(DiffuseMicrofacets, ArraysAreTheScalarsItemByItem) {
    const ltmd::AnyDistribution<double> d(GGX<double>(0.5));
    const std::vector<Direction<double>> wi(40, up), wo(40, grazing);
    std::vector<double> out(40);
    ltmd::diffuse_brdf<double>(d, wi, wo, ltmd::MaskingModel::v_cavity, 8, out);
    const double expected = diffuse_brdf(d, up, grazing, ltmd::MaskingModel::v_cavity, 8);
    EXPECT_GT(expected, 0);
    for (const double value : out) EXPECT_EQ(value, expected);
}

TEST(HeightMasking, TopAndBottom) {
    const GGX<float> d(0.5F);
    const Direction<float> v{0.8F, 0, 0.6F}, below{0.8F, 0, -0.6F}, m{0, 0, 1};
    EXPECT_EQ(G1_at_height(d, v, m, 1.F), 1);
    EXPECT_EQ(G1_at_height(d, v, m, 0.F), 0);
    EXPECT_EQ(G1_at_height(d, below, m, 0.F), 1);
    EXPECT_EQ(G2_at_height(d, v, below, m, 0.F), 0);
}

}  // namespace
