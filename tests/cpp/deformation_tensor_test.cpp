// SPDX-License-Identifier: Apache-2.0
#include "ltmd/deformation_tensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test_meshes.h"

namespace ltmd {
namespace {

constexpr float eps = std::numeric_limits<float>::epsilon();

std::vector<SymmetricTensor> measure(const test::OwnedMesh& mesh,
                                     const std::vector<Vec3f>& deformed) {
    const RestState rest(mesh.view(), mesh.positions);
    std::vector<SymmetricTensor> out(mesh.positions.size());
    deformation_tensor(rest, deformed, out);
    return out;
}

TEST(DeformationTensor, ProjectsToTheTensionOfAnAffineMap) {
    auto mesh = test::grid(3);
    std::vector<Vec3f> deformed;
    for (const Vec3f& p : mesh.positions)
        deformed.push_back({2 * p[0] + 0.5f * p[1], 0.25f * p[1], 0});
    for (bool with_uv : {true, false}) {
        if (!with_uv) mesh.corner_uv.clear();
        const auto tensors = measure(mesh, deformed);
        const std::vector<Vec3f> x(tensors.size(), {1, 0, 0}), y(tensors.size(), {0, 1, 0});
        std::vector<Tension> t(tensors.size());
        project_tensor(tensors, x, y, t);
        for (const Tension& value : t) {
            EXPECT_NEAR(value[0], 2, 100 * eps);
            EXPECT_NEAR(value[1], 0.5, 100 * eps);
            EXPECT_NEAR(value[2], 0.25, 100 * eps);
        }
    }
}

TEST(DeformationTensor, AtRestIsTheProjectorOnTheVertexPlaneWhateverTheFold) {
    // A roof: without the turn to the vertex normal its ridge would read as stretched.
    test::OwnedMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 1}, {2, 0, 0}, {0, 1, 0}, {1, 1, 1}, {2, 1, 0}};
    mesh.corner_vert = {0, 1, 4, 3, 1, 2, 5, 4};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    const auto tensors = measure(mesh, mesh.positions);
    for (int vertex : {0, 1, 4}) {
        // Determinant 0 and trace 2 with eigenvalues 1, 1, 0: B is its own square.
        const auto& b = tensors[vertex];
        const double m[3][3] = {{b[0], b[3], b[4]}, {b[3], b[1], b[5]}, {b[4], b[5], b[2]}};
        EXPECT_NEAR(m[0][0] + m[1][1] + m[2][2], 2, 100 * eps);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                EXPECT_NEAR(m[i][0] * m[0][j] + m[i][1] * m[1][j] + m[i][2] * m[2][j], m[i][j],
                            100 * eps);
    }
    EXPECT_NEAR(tensors[1][0], 1, 100 * eps);  // the ridge's plane is horizontal
    EXPECT_NEAR(tensors[1][2], 0, 100 * eps);
}

TEST(DeformationTensor, VerticesOfNoUsableFaceGetTheIdentity) {
    auto mesh = test::one_triangle();
    const SymmetricTensor identity = {1, 1, 1, 0, 0, 0};
    EXPECT_EQ(measure(mesh, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})[0], identity);
    mesh.positions[2] = {2, 0, 0};
    EXPECT_EQ(measure(mesh, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})[1], identity);
}

}  // namespace
}  // namespace ltmd
