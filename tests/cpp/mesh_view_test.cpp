// SPDX-License-Identifier: Apache-2.0
#include "ltmd/mesh_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ltmd/errors.h"
#include "test_meshes.h"

namespace ltmd {
namespace {

std::string message_of(const auto& action) {
    try {
        action();
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "no error";
}

TEST(MeshView, NamesTheFirstTriangleWithABadCorner) {
    auto mesh = test::grid(2);
    mesh.triangles[5][1] = 16;
    EXPECT_NE(message_of([&] { validate(mesh.view()); }).find("triangle 5 has corners"),
              std::string::npos);
    mesh.triangles[3][2] = -1;
    EXPECT_NE(message_of([&] { validate(mesh.view()); }).find("triangle 3 has corners"),
              std::string::npos);
}

TEST(MeshView, RefusesTrianglesWhoseCornersCannotBeCounted) {
    const auto mesh = test::grid(1);
    MeshView view = mesh.view();
    view.triangles = {view.triangles.data(), 715827883};  // never read
    EXPECT_EQ(message_of([&] { validate(view); }),
              "the mesh has 715827883 triangles; at most 715827882 are allowed");
}

TEST(MeshView, NamesTheFirstBadCorner) {
    auto mesh = test::grid(2);
    mesh.corner_vert[7] = 9;
    EXPECT_EQ(message_of([&] { validate(mesh.view()); }),
              "corner 7 has vertex 9; the mesh has vertices 0 to 8");
    mesh = test::grid(2);
    mesh.corner_uv[4][1] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(message_of([&] { validate(mesh.view()); }), "the UV of corner 4 is not finite");
}

TEST(MeshView, RefusesUvsOfAnotherLength) {
    auto mesh = test::grid(1);
    mesh.corner_uv.pop_back();
    EXPECT_EQ(message_of([&] { validate(mesh.view()); }),
              "corner_uv has 3 entries; corner_vert has 4");
}

TEST(MeshView, NamesTheFirstNonFinitePosition) {
    auto mesh = test::grid(400);  // enough for several pieces of work
    mesh.positions[150000][2] = std::nanf("");
    mesh.positions[99999][0] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(message_of([&] { validate_positions(mesh.view(), mesh.positions, "rest"); }),
              "the rest position of vertex 99999 is not finite");
}

TEST(MeshView, AcceptsHugeAndTinyPositions) {
    const auto mesh = test::one_triangle();
    const std::vector<Vec3f> positions = {{3e38f, 3e38f, 3e38f}, {1e-45f, 0, 0}, {-3e38f, 0, 0}};
    EXPECT_NO_THROW(validate_positions(mesh.view(), positions, "rest"));
}

TEST(MeshView, AnEmptyMeshIsValid) {
    const MeshView empty;
    EXPECT_NO_THROW(validate(empty));
    EXPECT_TRUE(tiles(empty).empty());
}

TEST(MeshView, TilesAreThoseThatFacesReachInto) {
    auto mesh = test::grid(4);
    EXPECT_EQ(tiles(mesh.view()), (std::vector<Tile>{{0, 0}}));  // touching a border is not enough
    for (auto& uv : mesh.corner_uv) uv = {uv[0] * 2 + 0.5f, uv[1] - 1.5f};
    EXPECT_EQ(tiles(mesh.view()),
              (std::vector<Tile>{{0, -2}, {1, -2}, {2, -2}, {0, -1}, {1, -1}, {2, -1}}));
}

TEST(MeshView, ATriangleAcrossACornerMissesTheFarTile) {
    auto mesh = test::one_triangle();
    mesh.corner_uv = {{0.5f, 0.5f}, {1.25f, 0.5f}, {0.5f, 1.25f}};  // cuts the corner (1, 1) off
    EXPECT_EQ(tiles(mesh.view()), (std::vector<Tile>{{0, 0}, {1, 0}, {0, 1}}));
}

TEST(MeshView, RefusesUvsBeyondAllTiles) {
    auto mesh = test::one_triangle();
    mesh.corner_uv[1][0] = 1e9f;
    EXPECT_NE(message_of([&] { tiles(mesh.view()); }).find("tiles from -1000 to 1000"),
              std::string::npos);
}

TEST(MeshView, Udim) {
    EXPECT_EQ(udim({0, 0}), 1001);
    EXPECT_EQ(udim({9, 1}), 1020);
    EXPECT_THROW(udim({10, 0}), InvalidInput);
    EXPECT_THROW(udim({0, -1}), InvalidInput);
}

}  // namespace
}  // namespace ltmd
