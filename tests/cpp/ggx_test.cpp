// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ggx.h"

#include <gtest/gtest.h>

#include "ltmd/any_distribution.h"
#include "ltmd/errors.h"
#include "ltmd/transformed_distribution.h"

namespace {

using ltmd::Direction;
using ltmd::GGX;
using ltmd::Matrix2;

constexpr double eps = std::numeric_limits<double>::epsilon();

TEST(Ggx, AllOfItIsBuiltFromTheLibrarysHeadersAlone) {
    static_assert(ltmd::MicrofacetDistribution<GGX<float>>);
    static_assert(ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<GGX<double>>>);
    static_assert(ltmd::MicrofacetDistribution<ltmd::AnyDistribution<float>>);
}

// microsurface-transformations, eq. 29: M = diag(alpha / alpha_x, alpha / alpha_y).
TEST(Ggx, StretchedIsotropicIsAnisotropic) {
    const GGX<double> classic(0.5, 0.05);
    const auto stretched = transformed(GGX<double>(0.2), Matrix2{0.2 / 0.5, 0, 0, 0.2 / 0.05});
    for (const Direction<double>& d :
         {Direction<double>{0, 0, 1}, {0.6, 0, 0.8}, {-0.48, 0.64, 0.6}, {0.1, -0.99, 0.0995}}) {
        const Direction<double> m = normalized(d);
        EXPECT_NEAR(stretched.D(m), classic.D(m), 100 * eps * classic.D(m));
        EXPECT_NEAR(stretched.Lambda(m), classic.Lambda(m), 100 * eps * (1 + classic.Lambda(m)));
        EXPECT_NEAR(stretched.projected_area(m), classic.projected_area(m), 100 * eps);
    }
}

TEST(Ggx, RefusesWhatIsOutOfRange) {
    for (const double alpha : {0.0, -0.1, 1e-7, 1e7, std::nan("")})
        EXPECT_THROW(GGX<float>(alpha, 0.1), ltmd::InvalidInput);
    EXPECT_THROW(transformed(GGX<float>(0.1), Matrix2{1, 2, 2, 4}), ltmd::InvalidInput);
}

}  // namespace
