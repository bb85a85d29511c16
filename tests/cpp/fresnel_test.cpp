// SPDX-License-Identifier: Apache-2.0
#include "ltmd/fresnel.h"

#include <gtest/gtest.h>

namespace {

TEST(Fresnel, NormalIncidenceHasOneFormulaForAll) {
    const double n = 1.5, f0 = 0.04;
    EXPECT_NEAR(ltmd::fresnel_dielectric(1., n), f0, 1e-16);
    EXPECT_NEAR(ltmd::fresnel_dielectric(-1., n), f0, 1e-16);
    EXPECT_NEAR(ltmd::fresnel_conductor(1., n, 0.), f0, 1e-16);
    EXPECT_EQ(ltmd::fresnel_schlick(1., f0), f0);
    EXPECT_EQ(ltmd::fresnel_f82(1., f0, 0.5), f0);
}

TEST(Fresnel, ADielectricIsAConductorThatDoesNotAbsorb) {
    for (float c = 0; c <= 1; c += 1.F / 64)
        EXPECT_NEAR(ltmd::fresnel_dielectric(c, 1.5F), ltmd::fresnel_conductor(c, 1.5F, 0.F), 1e-6);
}

TEST(Fresnel, NoInterfaceReflectsNothing) {
    for (const float c : {-1.F, -0.1F, 0.F, 0.5F, 1.F}) {
        EXPECT_EQ(ltmd::fresnel_dielectric(c, 1.F), 0);
        EXPECT_NEAR(ltmd::fresnel_conductor(c, 1.F, 0.F), 0, 1e-12);
    }
}

}  // namespace
