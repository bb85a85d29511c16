// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ltmd/mesh_view.h"

/// Wavefront OBJ files, read by tinyobjloader.
///
/// Faces of more than three corners are cut by that loader, from the rest positions alone: quads
/// along their shorter diagonal (corners 1 and 3 joined at equal length), larger polygons by ear
/// clipping. Groups and objects are one mesh; vertices are those of the file, in its order;
/// materials, normals, lines and points are not read.
namespace ltmd::cli {

struct ObjMesh {
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> corner_vert;
    std::vector<Vec2f> corner_uv;
    std::vector<Vec3f> positions;
    std::vector<std::int32_t>
        polygon_vert;  ///< Vertices of all faces as written, one after another.

    MeshView view() const;
};

/// Throws BadInput for a file that cannot be read, has no faces, faces without texture coordinates,
/// or polygons that the loader does not cut whole.
ObjMesh read_rest(const std::string& path);

/// The positions of a deformed state; its texture coordinates are not used. Throws BadInput when it
/// has other vertices or faces than `rest`, with both counts.
std::vector<Vec3f> read_deformed(const std::string& path, const ObjMesh& rest);

}  // namespace ltmd::cli
