// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tension.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ltmd/errors.h"
#include "ltmd/threads.h"
#include "test_meshes.h"

namespace ltmd {
namespace {

using test::OwnedMesh;

constexpr float eps = std::numeric_limits<float>::epsilon();

std::vector<Tension> measure(const OwnedMesh& mesh, const std::vector<Vec3f>& deformed, Per per) {
    const RestState rest(mesh.view(), mesh.positions);
    std::vector<Tension> out(tension_count(rest, per));
    tension(rest, deformed, per, out);
    return out;
}

std::vector<Vec3f> map(const std::vector<Vec3f>& points, const auto& function) {
    std::vector<Vec3f> out;
    for (const Vec3f& p : points) out.push_back(function(p));
    return out;
}

void expect_near(const Tension& t, const Tension& expected, float tolerance) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(t[k], expected[k], tolerance) << "component " << k;
}

TEST(Tension, UndeformedIsTheIdentity) {
    const auto mesh = test::random_soup(500);
    for (Per per : {Per::triangle, Per::corner, Per::vertex})
        for (const Tension& t : measure(mesh, mesh.positions, per))
            expect_near(t, identity_tension, 100 * eps);
}

TEST(Tension, OfAShearedStretchIsItsUpperTriangularFactor) {
    const auto mesh = test::grid(3);
    const auto deformed = map(mesh.positions, [](Vec3f p) {
        return Vec3f{2 * p[0] + 0.5f * p[1] + 7, 0.25f * p[1] - 3, 1};
    });
    for (Per per : {Per::triangle, Per::corner, Per::vertex})
        for (const Tension& t : measure(mesh, deformed, per))
            expect_near(t, {2, 0.5f, 0.25f}, 100 * eps);
}

TEST(Tension, IsInTheUvFrameNotTheWorlds) {
    // U runs along world y: stretching world y by 3 is stretching U.
    auto mesh = test::grid(2);
    for (auto& uv : mesh.corner_uv) uv = {uv[1], -uv[0]};
    const auto deformed = map(mesh.positions, [](Vec3f p) { return Vec3f{p[0], 3 * p[1], 0}; });
    for (const Tension& t : measure(mesh, deformed, Per::corner))
        expect_near(t, {3, 0, 1}, 100 * eps);
}

TEST(Tension, MirroredUvsKeepTheGeometricNormal) {
    // Mirroring U turns x and y by half a turn: a shear keeps its sign. Mirroring V leaves x and y
    // alone.
    for (int axis : {0, 1}) {
        auto mesh = test::grid(2);
        for (auto& uv : mesh.corner_uv) uv[axis] = -uv[axis];
        const auto deformed =
            map(mesh.positions, [](Vec3f p) { return Vec3f{p[0] + 0.5f * p[1], p[1], 0}; });
        for (const Tension& t : measure(mesh, deformed, Per::corner))
            expect_near(t, {1, 0.5f, 1}, 100 * eps);
        EXPECT_EQ(RestState(mesh.view(), mesh.positions).report().mirrored_triangles,
                  mesh.triangles.size());
    }
}

TEST(Tension, DegenerateRestTrianglesGiveTheIdentityAndAreCounted) {
    auto mesh = test::one_triangle();
    mesh.positions[2] = {2, 0, 0};
    EXPECT_EQ(RestState(mesh.view(), mesh.positions).report().degenerate_triangles, 1u);
    EXPECT_EQ(measure(mesh, {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}}, Per::corner)[0], identity_tension);
    mesh = test::one_triangle();
    mesh.corner_uv[2] = {2, 0};
    EXPECT_EQ(RestState(mesh.view(), mesh.positions).report().no_uv_triangles, 1u);
    EXPECT_EQ(measure(mesh, {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}}, Per::triangle)[0], identity_tension);
}

TEST(Tension, ACollapsedTriangleIsClamped) {
    const auto mesh = test::one_triangle();
    expect_near(measure(mesh, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, Per::triangle)[0],
                {1e-3f, 0, 1e-3f}, 1e-9f);
    expect_near(measure(mesh, {{0, 0, 0}, {0, 0, 0}, {0, 2, 0}}, Per::triangle)[0], {1e-3f, 0, 2},
                2 * eps);
    expect_near(measure(mesh, {{0, 0, 0}, {1e6f, 0, 0}, {0, 1, 0}}, Per::triangle)[0], {1e3f, 0, 1},
                1e3f * eps);
}

TEST(Tension, AveragesNeverCrossASeam) {
    // Two quads that share an edge in space and not in UV, stretched by 2 and by 1/2.
    OwnedMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
    mesh.corner_vert = {0, 1, 4, 3, 1, 2, 5, 4};
    mesh.corner_uv = {{0, 0},   {.25f, 0}, {.25f, .25f}, {0, .25f},
                      {.5f, 0}, {.75f, 0}, {.75f, .25f}, {.5f, .25f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    const std::vector<Vec3f> deformed = {{0, 0, 0}, {2, 0, 0}, {2.5f, 0, 0},
                                         {0, 1, 0}, {2, 1, 0}, {2.5f, 1, 0}};
    const auto corners = measure(mesh, deformed, Per::corner);
    for (int c = 0; c < 8; ++c) expect_near(corners[c], {c < 4 ? 2.f : 0.5f, 0, 1}, 100 * eps);
    EXPECT_EQ(RestState(mesh.view(), mesh.positions).report().seam_vertices, 2u);
    expect_near(measure(mesh, deformed, Per::vertex)[1], {1, 0, 1}, 100 * eps);  // mixes both
    // Without the seam each shared corner takes the mean, weighted by the rest areas that meet
    // there (2 : 1).
    mesh.corner_uv = {{0, 0},    {.25f, 0}, {.25f, .25f}, {0, .25f},
                      {.25f, 0}, {.5f, 0},  {.5f, .25f},  {.25f, .25f}};
    const auto joined = measure(mesh, deformed, Per::corner);
    expect_near(joined[1], {(2 * 1 + 0.5f * 2) / 3, 0, 1}, 100 * eps);
    expect_near(joined[4], joined[1], 0);
    EXPECT_EQ(RestState(mesh.view(), mesh.positions).report().seam_vertices, 0u);
}

TEST(Tension, HasTheSameBitsForAnyThreadCount) {
    const auto mesh = test::grid(150);
    const auto deformed = map(mesh.positions, [](Vec3f p) {
        return Vec3f{p[0] + 0.1f * std::sin(9 * p[1]), p[1] * p[1] + p[1],
                     0.2f * std::cos(7 * p[0])};
    });
    for (Per per : {Per::triangle, Per::corner, Per::vertex}) {
        set_thread_count(1);
        const auto single = measure(mesh, deformed, per);
        for (int threads : {2, 3, 8}) {
            set_thread_count(threads);
            EXPECT_EQ(measure(mesh, deformed, per), single);
        }
    }
    set_thread_count(0);
}

TEST(Tension, RefusesAnotherTopology) {
    const auto mesh = test::grid(2);
    const RestState rest(mesh.view(), mesh.positions);
    std::vector<Tension> out(tension_count(rest, Per::corner));
    EXPECT_THROW(tension(rest, std::vector<Vec3f>(8), Per::corner, out), InvalidInput);
    out.pop_back();
    EXPECT_THROW(tension(rest, mesh.positions, Per::corner, out), InvalidInput);
}

TEST(Tension, AnEmptyMeshHasNone) {
    const RestState rest(MeshView{}, {});
    for (Per per : {Per::triangle, Per::corner, Per::vertex}) {
        EXPECT_EQ(tension_count(rest, per), 0u);
        EXPECT_NO_THROW(tension(rest, {}, per, {}));
    }
}

TEST(Stretch, IsThePrincipalStretchesAndTheAreaRatio) {
    // A pure shear by 1 has principal stretches golden ratio and its inverse.
    const std::vector<Tension> t = {{1, 1, 1}, {2, 0, 0.25f}, identity_tension};
    std::vector<Vec3f> out(3);
    stretch(t, out);
    const float golden = (1 + std::sqrt(5.f)) / 2;
    expect_near(out[0], {golden, 1 / golden, 1}, 4 * eps);
    expect_near(out[1], {2, 0.25f, 0.5f}, 4 * eps);
    expect_near(out[2], {1, 1, 1}, 0);
}

}  // namespace
}  // namespace ltmd
