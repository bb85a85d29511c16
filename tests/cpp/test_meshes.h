// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "ltmd/mesh_view.h"

/// Small meshes for tests, with their arrays.
namespace ltmd::test {

struct OwnedMesh {
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> corner_vert;
    std::vector<Vec2f> corner_uv;
    std::vector<Vec3f> positions;

    MeshView view() const {
        return {triangles, corner_vert, corner_uv, static_cast<std::int32_t>(positions.size())};
    }
};

/// A flat n x n grid of quads over the unit square with UV = (x, y), each quad cut in two.
inline OwnedMesh grid(int n) {
    OwnedMesh mesh;
    const auto size = static_cast<float>(n);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            mesh.positions.push_back(
                {static_cast<float>(i) / size, static_cast<float>(j) / size, 0});
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int first = static_cast<int>(mesh.corner_vert.size());
            for (int vertex : {j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1,
                               (j + 1) * (n + 1) + i}) {
                mesh.corner_vert.push_back(vertex);
                mesh.corner_uv.push_back({mesh.positions[vertex][0], mesh.positions[vertex][1]});
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
            mesh.triangles.push_back({first, first + 2, first + 3});
        }
    return mesh;
}

/// One triangle (0,0), (1,0), (0,1) with UV = (x, y).
inline OwnedMesh one_triangle() {
    return {{{0, 1, 2}}, {0, 1, 2}, {{0, 0}, {1, 0}, {0, 1}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
}

/// `count` unconnected triangles with random positions and UVs, none thin.
inline OwnedMesh random_soup(int count) {
    std::mt19937 random(0);
    std::uniform_real_distribution<float> uniform(-1, 1);
    OwnedMesh mesh;
    while (static_cast<int>(mesh.triangles.size()) < count) {
        std::array<Vec3f, 3> p;
        std::array<Vec2f, 3> uv;
        for (int k = 0; k < 3; ++k) {
            p[k] = {uniform(random), uniform(random), uniform(random)};
            uv[k] = {uniform(random), uniform(random)};
        }
        const float area = (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) -
                           (uv[2][0] - uv[0][0]) * (uv[1][1] - uv[0][1]);
        if (std::abs(area) < 0.1f) continue;
        const int first = static_cast<int>(mesh.positions.size());
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back(p[k]);
            mesh.corner_vert.push_back(first + k);
            mesh.corner_uv.push_back(uv[k]);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

}  // namespace ltmd::test
