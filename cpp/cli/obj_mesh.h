// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ltmd/mesh_view.h"

/// Wavefront OBJ files, read by tinyobjloader.
///
/// Faces of more than three corners are cut at rest (polygon.h), so that every state has the same
/// triangles; not by the loader, whose ear clipping leaves holes and overlaps in concave polygons
/// away from the origin. Groups and objects are one mesh; vertices are those of the file, in its
/// order; materials, normals, lines and points are not read.
namespace ltmd::cli {

struct ObjMesh {
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> corner_vert;
    std::vector<Vec2f> corner_uv;
    std::vector<Vec3f> positions;
    std::vector<std::size_t> face_sizes;  ///< Corners of each face as written, in corner order.

    MeshView view() const;
};

/// Throws BadInput for a file that cannot be read, or has no faces or faces without texture
/// coordinates.
ObjMesh read_rest(const std::string& path);

/// The positions of a deformed state; its texture coordinates are not used. Throws BadInput when it
/// has other vertices or faces than `rest`, with both counts.
std::vector<Vec3f> read_deformed(const std::string& path, const ObjMesh& rest);

}  // namespace ltmd::cli
