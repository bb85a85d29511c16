// SPDX-License-Identifier: Apache-2.0
#include "obj_mesh.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "errors.h"

namespace ltmd::cli {
namespace {

struct ObjFile {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::index_t> corners;  ///< Of all faces, one face after another.
    std::size_t faces = 0;
};

ObjFile load(const std::string& path, bool triangulate) {
    std::ifstream stream{std::filesystem::path(path), std::ios::binary};
    std::error_code error;
    if (!stream || std::filesystem::is_directory(path, error))
        throw BadInput(path + ": cannot be read" +
                       (std::filesystem::exists(path, error) ? "" : " (there is no such file)"));
    ObjFile file;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning, problem;
    // No material reader: a missing .mtl file is no problem here.
    const bool read = tinyobj::LoadObj(&file.attributes, &shapes, &materials, &warning, &problem,
                                       &stream, nullptr, triangulate, false);
    if (!read || !problem.empty()) {
        problem.erase(std::find(problem.begin(), problem.end(), '\n'), problem.end());
        throw BadInput(path + ": is not a valid OBJ file" +
                       (problem.empty() ? "" : " (" + problem + ")"));
    }
    for (const tinyobj::shape_t& shape : shapes) {
        file.corners.insert(file.corners.end(), shape.mesh.indices.begin(),
                            shape.mesh.indices.end());
        file.faces += shape.mesh.num_face_vertices.size();
    }
    return file;
}

std::vector<Vec3f> positions_of(const ObjFile& file) {
    const std::vector<float>& v = file.attributes.vertices;
    std::vector<Vec3f> positions(v.size() / 3);
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    return positions;
}

/// Throws when a face names a vertex or texture coordinate that the file does not have.
void check_indices(const std::string& path, const ObjFile& file) {
    const std::size_t vertices = file.attributes.vertices.size() / 3,
                      uvs = file.attributes.texcoords.size() / 2;
    for (const tinyobj::index_t& corner : file.corners) {
        if (corner.vertex_index < 0 || static_cast<std::size_t>(corner.vertex_index) >= vertices)
            throw BadInput(path + ": a face uses vertex " +
                           std::to_string(corner.vertex_index + 1) + " of " +
                           std::to_string(vertices));
        if (corner.texcoord_index >= 0 && static_cast<std::size_t>(corner.texcoord_index) >= uvs)
            throw BadInput(path + ": a face uses texture coordinate " +
                           std::to_string(corner.texcoord_index + 1) + " of " +
                           std::to_string(uvs));
    }
}

std::vector<std::int32_t> vertices_of(const ObjFile& file) {
    std::vector<std::int32_t> vertices;
    vertices.reserve(file.corners.size());
    for (const tinyobj::index_t& corner : file.corners) vertices.push_back(corner.vertex_index);
    return vertices;
}

}  // namespace

MeshView ObjMesh::view() const {
    return {triangles, corner_vert, corner_uv, static_cast<std::int32_t>(positions.size())};
}

ObjMesh read_rest(const std::string& path) {
    ObjMesh mesh;
    std::size_t whole = 0;
    {
        const ObjFile polygons = load(path, false);
        check_indices(path, polygons);
        if (polygons.faces == 0) throw BadInput(path + ": has no faces");
        const auto without_uv =
            std::count_if(polygons.corners.begin(), polygons.corners.end(),
                          [](const tinyobj::index_t& c) { return c.texcoord_index < 0; });
        if (without_uv > 0)
            throw BadInput(path + ": has " +
                           (polygons.attributes.texcoords.empty()
                                ? std::string("no texture coordinates (vt)")
                                : std::to_string(without_uv) +
                                      " face corners without a texture coordinate (vt)") +
                           "; unwrap the mesh and export it with UVs");
        mesh.polygon_vert = vertices_of(polygons);
        whole = polygons.corners.size() - 2 * polygons.faces;
    }
    const ObjFile file = load(path, true);
    mesh.positions = positions_of(file);
    mesh.corner_vert = vertices_of(file);
    mesh.triangles.resize(file.corners.size() / 3);
    if (mesh.triangles.size() != whole)
        throw BadInput(path + ": has polygons that cannot be cut into triangles (" +
                       std::to_string(whole - mesh.triangles.size()) +
                       " triangles would be missing); triangulate it before exporting");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto first = static_cast<std::int32_t>(3 * t);
        mesh.triangles[t] = {first, first + 1, first + 2};
    }
    const std::vector<float>& vt = file.attributes.texcoords;
    mesh.corner_uv.reserve(file.corners.size());
    for (const tinyobj::index_t& corner : file.corners) {
        const auto i = 2 * static_cast<std::size_t>(corner.texcoord_index);
        mesh.corner_uv.push_back({vt[i], vt[i + 1]});
    }
    return mesh;
}

std::vector<Vec3f> read_deformed(const std::string& path, const ObjMesh& rest) {
    const ObjFile file = load(path, false);
    std::vector<Vec3f> positions = positions_of(file);
    if (positions.size() != rest.positions.size())
        throw BadInput(path + ": has " + std::to_string(positions.size()) +
                       " vertices, the rest state has " + std::to_string(rest.positions.size()));
    if (file.corners.size() != rest.polygon_vert.size())
        throw BadInput(path + ": has " + std::to_string(file.corners.size()) +
                       " face corners, the rest state has " +
                       std::to_string(rest.polygon_vert.size()));
    if (vertices_of(file) != rest.polygon_vert)
        throw BadInput(path + ": its faces join other vertices than those of the rest state");
    return positions;
}

}  // namespace ltmd::cli
