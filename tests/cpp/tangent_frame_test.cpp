// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tangent_frame.h"

#include <gtest/gtest.h>

#include "test_meshes.h"

namespace ltmd {
namespace {

// The contract: x = dP/du normalised, z = geometric normal e1 x e2, y = z x x; mirrored UVs change
// x only.

TEST(TangentFrame, FollowsUOfThePlane) {
    const auto mesh = test::one_triangle();
    TangentFrame frame;
    ASSERT_TRUE(tangent_frame(mesh.positions[0], mesh.positions[1], mesh.positions[2], {0, 0},
                              {1, 0}, {0, 1}, frame));
    EXPECT_EQ(frame.x, (Vec3d{1, 0, 0}));
    EXPECT_EQ(frame.y, (Vec3d{0, 1, 0}));
    EXPECT_EQ(frame.z, (Vec3d{0, 0, 1}));
}

TEST(TangentFrame, MirroredUvsTurnXAlone) {
    const auto mesh = test::one_triangle();
    TangentFrame frame;
    ASSERT_TRUE(tangent_frame(mesh.positions[0], mesh.positions[1], mesh.positions[2], {0, 0},
                              {-1, 0}, {0, 1}, frame));
    EXPECT_EQ(frame.x, (Vec3d{-1, 0, 0}));
    EXPECT_EQ(frame.y, (Vec3d{0, -1, 0}));
    EXPECT_EQ(frame.z, (Vec3d{0, 0, 1}));
    EXPECT_EQ(uv_area_sign({0, 0}, {-1, 0}, {0, 1}), -1);
}

TEST(TangentFrame, IsOrthonormalAndRightHanded) {
    const auto mesh = test::random_soup(200);
    for (const Triangle& t : mesh.triangles) {
        TangentFrame f;
        ASSERT_TRUE(tangent_frame(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]],
                                  mesh.corner_uv[t[0]], mesh.corner_uv[t[1]], mesh.corner_uv[t[2]],
                                  f));
        const auto dot = [](const Vec3d& a, const Vec3d& b) {
            return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        };
        EXPECT_NEAR(dot(f.x, f.x), 1, 1e-14);
        EXPECT_NEAR(dot(f.x, f.z), 0, 1e-13);
        EXPECT_NEAR(f.y[0], f.z[1] * f.x[2] - f.z[2] * f.x[1], 1e-15);
    }
}

TEST(TangentFrame, RefusesDegenerateTriangles) {
    TangentFrame frame;
    const Vec2f a = {0, 0}, b = {1, 0}, c = {0, 1};
    EXPECT_FALSE(tangent_frame({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, a, b, c, frame));  // no area
    EXPECT_FALSE(
        tangent_frame({0, 0, 0}, {1, 0, 0}, {0, 0.9e-7f, 0}, a, b, c, frame));  // below 1e-7
    EXPECT_TRUE(tangent_frame({0, 0, 0}, {1, 0, 0}, {0, 1.1e-7f, 0}, a, b, c, frame));
    EXPECT_FALSE(
        tangent_frame({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, a, b, {2, 0}, frame));  // no UV area
    EXPECT_FALSE(tangent_frame({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, a, b, c, frame));
}

}  // namespace
}  // namespace ltmd
