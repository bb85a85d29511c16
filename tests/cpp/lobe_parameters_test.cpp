// SPDX-License-Identifier: Apache-2.0
#include "ltmd/lobe_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/passes.h"

namespace {

using namespace ltmd;

Vec3f parameters(const Tension& t, const Lobe& lobe) {
    Vec3f out;
    lobe_parameters({&t, 1}, lobe, {&out, 1});
    return out;
}

TEST(LobeParameters, StretchingNarrowsTheLobeAlongIt) {
    const Vec3f along_u = parameters({2, 0, 1}, {.alpha_x = 0.2, .alpha_y = 0.2});
    EXPECT_FLOAT_EQ(along_u[0], 0.1f);
    EXPECT_FLOAT_EQ(along_u[1], 0.2f);
    EXPECT_FLOAT_EQ(along_u[2], 0);
    const Vec3f along_v = parameters({1, 0, 4}, {.alpha_x = 0.2, .alpha_y = 0.2});
    EXPECT_FLOAT_EQ(along_v[0], 0.05f);
    EXPECT_FLOAT_EQ(along_v[2], std::numbers::pi_v<float> / 2);
    // Just below pi, where rounding would leave the range.
    EXPECT_EQ(parameters({2, -1e-9f, 1}, {.alpha_x = 0.2, .alpha_y = 0.2})[2], 0);
    const Vec3f squeezed = parameters({0.1f, 0, 0.1f}, {.alpha_x = 0.2, .alpha_y = 0.2});
    EXPECT_FLOAT_EQ(squeezed[0], 2);
    EXPECT_EQ(squeezed[0], squeezed[1]);
    EXPECT_EQ(squeezed[2], 0);
}

TEST(LobeParameters, HeightResponseOneKeepsVolume) {
    const Lobe lobe = {.alpha_x = 0.2, .alpha_y = 0.2, .height_response = 1};
    const Vec3f p = parameters({2, 0, 2}, lobe);  // four times the area, a quarter of the height
    EXPECT_FLOAT_EQ(p[0], 0.2f / 2 / 4);
}

TEST(LobeParameters, ExtremesStayFinite) {
    for (const float s : {1e-3f, 1e3f})
        for (const float r : {1e-3f, 1e3f})
            for (const double strength : {0.0, 1.0, 2.0, 10.0})
                for (const double height : {-1.0, 0.0, 1.0}) {
                    const Lobe lobe = {.strength = strength, .height_response = height};
                    const Tension t = {s, 0.5f * r, r};
                    std::array<float, 4> rough;
                    Vec3f sigma;
                    roughness({&t, 1}, lobe, {&rough, 1});
                    alpha2({&t, 1}, lobe, {&sigma, 1});
                    for (const float v : rough) EXPECT_TRUE(std::isfinite(v));
                    for (const float v : sigma) EXPECT_TRUE(std::isfinite(v));
                    EXPECT_LE(rough[0], rough[1]);
                }
}

TEST(LobeParameters, RefusesWhatHasNoMeaning) {
    const Tension t = identity_tension;
    Vec3f out;
    const auto message = [&](const Lobe& lobe, const Tension& tension = identity_tension) {
        try {
            alpha2({&tension, 1}, lobe, {&out, 1});
        } catch (const InvalidInput& error) {
            return std::string(error.what());
        }
        return std::string("nothing");
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double alpha : {0.0, -0.1, nan})
        EXPECT_NE(message({.alpha_y = alpha}).find("alpha is"), std::string::npos);
    for (const Matrix2& m :
         {Matrix2{1, 2, 2, 4}, {0, 0, 0, 0}, {1, 0, 0, nan}, {1, 1, 1, 1 + 1e-9}})
        EXPECT_NE(message({.m0 = m}).find("invertible"), std::string::npos);
    EXPECT_NE(message({.strength = -1}).find("strength"), std::string::npos);
    EXPECT_NE(message({.height_response = nan}).find("height_response"), std::string::npos);
    EXPECT_NE(message({}, {1, 0, 0}).find("tension 0 is (1, 0, 0)"), std::string::npos);
    EXPECT_THROW(alpha2({&t, 1}, {}, {}), InvalidInput);
    for (const double s : {-1.0, 1.0, 2.0, nan}) EXPECT_THROW(stretch_matrix(s), InvalidInput);
    EXPECT_THROW(material_matrix(0, nan, 0), InvalidInput);
}

TEST(Passes, EachHasItsChannels) {
    EXPECT_EQ(pass_names().size(), 5u);
    const Tension t = {2, 0.5f, 1};
    for (const std::string& pass : pass_names()) {
        std::vector<float> values;
        compute_pass(pass, {&t, 1}, {}, values);
        EXPECT_EQ(values.size(), static_cast<std::size_t>(pass_channels(pass)));
    }
    std::vector<float> wrinkles;
    compute_pass("wrinkle", {&t, 1}, {}, wrinkles);
    EXPECT_FLOAT_EQ(wrinkles[1], std::sqrt(1.25f));
    EXPECT_FLOAT_EQ(wrinkles[2], std::atan(0.5f));
    EXPECT_THROW(pass_channels("tensoin"), InvalidInput);
}

}  // namespace
