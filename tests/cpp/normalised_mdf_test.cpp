// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "ltmd/ashikhmin_shirley.h"
#include "ltmd/errors.h"
#include "ltmd/gauss.h"
#include "ltmd/sawicki_ds.h"
#include "ltmd/schlick_mdf.h"
#include "ltmd/sheen.h"
#include "ltmd/transformed_distribution.h"

namespace {

using ltmd::Direction;

/// Both precisions, plain and under M, agree on masking and have samples that face the view.
template <class Single, class Double>
void expect_consistent(const Single& single, const Double& full) {
    static_assert(ltmd::MicrofacetDistribution<Single>);
    static_assert(ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<Double>>);
    for (const double z : {1.0, 0.9, 0.3, 0.01}) {
        const double x = std::sqrt(1 - z * z);
        const Direction<double> v{x, 0, z};
        const Direction<float> w{static_cast<float>(x), 0, static_cast<float>(z)};
        // float's own rounding of z, 1e-8 absolute, is 1e-6 of the smallest.
        EXPECT_NEAR(single.projected_area(w), full.projected_area(v),
                    2e-6 * full.projected_area(v));
        for (const double a : {0.01, 0.4, 0.9})
            for (const double b : {0.1, 0.5, 0.99}) {
                const Direction<double> m = full.sample_visible(v, {a, b});
                EXPECT_GT(dot(m, v), 0);
                EXPECT_NEAR(length(m), 1, 1e-14);
                EXPECT_GT(full.pdf_visible(v, m), 0);
            }
    }
}

TEST(NormalisedMdf, WorkInBothPrecisionsAndUnderM) {
    expect_consistent(ltmd::Gauss<float>(0.4), ltmd::Gauss<double>(0.4));
    expect_consistent(ltmd::SchlickMDF<float>(0.4), ltmd::SchlickMDF<double>(0.4));
    expect_consistent(ltmd::SawickiDS<float>(20), ltmd::SawickiDS<double>(20));
    expect_consistent(ltmd::Sheen<float>(0.3), ltmd::Sheen<double>(0.3));
    expect_consistent(ltmd::AshikhminShirley<float>(5, 50), ltmd::AshikhminShirley<double>(5, 50));
    const ltmd::Matrix2 shear{1, 0.4, -2, 1.5};
    expect_consistent(transformed(ltmd::AshikhminShirley<float>(5, 50), shear),
                      transformed(ltmd::AshikhminShirley<double>(5, 50), shear));
}

TEST(NormalisedMdf, RefuseWhatIsOutOfRange) {
    EXPECT_THROW(ltmd::Gauss<float>(0), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::SchlickMDF<float>(1.5), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::SawickiDS<float>(std::nan("")), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::Sheen<float>(2), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::AshikhminShirley<float>(1, -1), ltmd::InvalidInput);
}

}  // namespace
