// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ltmd/rest_state.h"

namespace ltmd::inline v0 {

enum class TriangleState : std::uint8_t {
    regular,
    no_uv,    ///< R^-1 is in some frame of the triangle: good for tensors alone.
    no_area,  ///< R^-1 is not set.
};

/// Lists of triangles, one list per item: item i has triangles[offsets[i] .. offsets[i + 1]).
struct TriangleLists {
    std::vector<std::int32_t> offsets;
    std::span<const std::int32_t> triangles;

    std::size_t size() const { return offsets.size() - 1; }
    std::span<const std::int32_t> operator[](std::size_t i) const {
        return triangles.subspan(offsets[i], offsets[i + 1] - offsets[i]);
    }
};

struct RestState::Data {
    RestReport report;
    std::size_t corner_count = 0;
    std::size_t vertex_count = 0;
    bool has_uv = false;

    // Per triangle.
    std::vector<std::array<std::int32_t, 3>> vertices;
    std::array<std::vector<double>, 4> inverse_rest;  ///< R^-1: xx, xy, yx, yy, each on its own.
    std::vector<float> weight;                        ///< Rest area as a part of the largest.
    std::vector<TriangleState> state;
    std::vector<std::int32_t>
        irregular;  ///< Triangles that are not TriangleState::regular, sorted.

    std::vector<std::int32_t> listed;      ///< The triangles of each vertex, fan by fan.
    TriangleLists vertex_triangles;        ///< All triangles of each vertex: in `listed`.
    TriangleLists fans;                    ///< The triangles of each UV fan: in `listed` too.
    std::vector<std::int32_t> corner_fan;  ///< [C], -1 for a corner of no triangle.
};

}  // namespace ltmd::inline v0
