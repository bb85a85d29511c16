// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ltmd/mesh_view.h"

namespace ltmd::cli {

/// Appends the n - 2 triangles of a polygon with n >= 3 corners, as indices of its corners, in its
/// orientation. A quad is cut along its shorter diagonal that lies inside (corners 1 and 3 at equal
/// length), larger polygons by ear clipping, both as seen along the polygon's mean normal.
void cut_polygon(std::span<const Vec3f> corners, std::vector<std::array<std::size_t, 3>>& out);

}  // namespace ltmd::cli
