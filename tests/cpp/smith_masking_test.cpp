// SPDX-License-Identifier: Apache-2.0
#include "ltmd/smith_masking.h"

#include <gtest/gtest.h>

#include "ltmd/errors.h"
#include "ltmd/ggx.h"

namespace {

double ggx_shape(double r) { return std::numbers::inv_pi / ((1 + r * r) * (1 + r * r)); }

TEST(SmithMasking, OfASharpShapeByItsOwnSlopes) {
    // The slope scale is part of the shape: the quadrature finds it.
    const double alpha = 1e-3;
    const ltmd::GGX<double> d(alpha);
    const auto shape = [&](double r) { return ggx_shape(r / alpha) / (alpha * alpha); };
    for (const double cotangent : {1e-4, 1e-3, 0.1}) {
        const double expected = d.Lambda({1, 0, cotangent});
        EXPECT_NEAR(ltmd::smith_lambda_of_shape(shape, cotangent), expected, 1e-9 * expected);
        EXPECT_NEAR(ltmd::smith_lambda_of_shape(ggx_shape, cotangent / alpha), expected,
                    1e-9 * expected);
    }
    EXPECT_NEAR(ltmd::shape_integral(shape), 1, 1e-11);
}

TEST(SmithMasking, RefusesSlopesWithoutAMean) {
    const auto heavy = [](double x) { return 1 / (1 + x * x); };
    EXPECT_THROW(ltmd::smith_lambda(heavy, 1), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::smith_lambda(ggx_shape, 0), ltmd::InvalidInput);
}

}  // namespace
