// SPDX-License-Identifier: Apache-2.0
#include "ltmd/mdf_conversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ltmd/errors.h"

namespace {

using namespace ltmd;
using enum MdfParameter;

TEST(MdfConversion, NamesAreTheirParametersAndMethods) {
    for (std::size_t i = 0; i < mdf_parameters.size(); ++i)
        EXPECT_EQ(parse_mdf_parameter(mdf_parameters[i].name), static_cast<MdfParameter>(i));
    EXPECT_STREQ(mdf_info(schlick_m).name, "schlick_m");
    EXPECT_EQ(parse_mdf_method("ward"), MdfMethod::ward);
    EXPECT_THROW(parse_mdf_parameter("phong"), InvalidInput);
    EXPECT_THROW(parse_mdf_method(""), InvalidInput);
}

/// microfacet-distribution-conversion, Table 2, to its digits.
TEST(MdfConversion, LeastSquaresOfTable2) {
    for (const auto& [m, n] : {std::pair(0.2, 47.33), {0.1, 197.3}, {0.01, 19997.}}) {
        const MdfConversion conversion(beckmann_alpha, phong_exponent);
        EXPECT_NEAR(conversion(m), n, 2e-4 * n);
        const MdfFit fit = fit_mdf(beckmann_alpha, m, phong_exponent, 4 * m);
        EXPECT_NEAR(fit.value, conversion(m), 1e-9 * n);
    }
    EXPECT_NEAR(fit_mdf(beckmann_alpha, 0.1, ggx_alpha, 0.4).rmse, 0.03617, 5e-6);
}

TEST(MdfConversion, HalfAnglesAreWhereTheUnitFormIsOneHalf) {
    const MdfConversion conversion(ggx_alpha, sawicki_n, MdfMethod::half_angle);
    const double alpha = 0.3, cosine2 = (std::sqrt(2) * alpha * alpha - 1) / (alpha * alpha - 1);
    const double beta = std::acos(std::sqrt(cosine2));  // eq. 8
    EXPECT_NEAR(unit_mdf(sawicki_n, conversion(alpha), beta), 0.5, 1e-12);
    EXPECT_NEAR(unit_mdf(ggx_alpha, alpha, beta), 0.5, 1e-12);
}

TEST(MdfConversion, ArraysAndTheRange) {
    const MdfConversion conversion(ggx_alpha, phong_exponent);
    std::vector<double> from{0.1, 0.2, conversion.high()}, to(3);
    conversion(from, to);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(to[i], conversion(from[i]));
    EXPECT_THROW(conversion(conversion.high() * 1.001), InvalidInput);
    EXPECT_THROW(conversion(conversion.low() / 1.001), InvalidInput);
    EXPECT_THROW(conversion(std::nan("")), InvalidInput);
    to.pop_back();
    EXPECT_THROW(conversion(from, to), InvalidInput);
    EXPECT_THROW(MdfConversion(gauss_m, phong_exponent, MdfMethod::ward), InvalidInput);
    EXPECT_THROW(MdfConversion(gtr_alpha, phong_exponent, MdfMethod::rmse, 0.4), InvalidInput);
}

}  // namespace
