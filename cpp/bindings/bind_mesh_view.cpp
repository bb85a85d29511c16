// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "bindings.h"

namespace ltmd::python {

MeshView Mesh::view() const {
    MeshView view{items<Triangle>(triangles), items<std::int32_t>(corner_vert), {}, vertex_count};
    if (corner_uv) view.corner_uv = items<Vec2f>(*corner_uv);
    return view;
}

Tile parse_tile(py::handle tile) {
    if (!py::isinstance<py::sequence>(tile) || py::len(tile) != 2)
        throw py::value_error("tile must be a pair of integers (u, v), not " +
                              std::string(py::repr(tile)));
    const auto pair = py::reinterpret_borrow<py::sequence>(tile);
    return {pair[0].cast<int>(), pair[1].cast<int>()};
}

void bind_mesh_view(py::module_& module) {
    using namespace py::literals;
    py::class_<Mesh, std::shared_ptr<Mesh>>(
        module, "Mesh",
        R"(A corner-based triangle mesh; keeps the arrays, copies none that is C-contiguous.

triangles: int32[T, 3], indices of corners; cut n-gons as the renderer cuts them.
corner_vert: int32[C], the vertex of each corner.
corner_uv: float32[C, 2] with v up, tile (0, 0) = UDIM 1001, or None for a mesh without a UV map.
vertex_count: V.
Raises TypeError for another dtype and ValueError for another shape, an index out of range or a UV that is not finite.)")
        .def(py::init([](py::handle triangles, py::handle corner_vert, py::handle corner_uv,
                         std::int32_t vertex_count) {
                 auto mesh = std::make_shared<Mesh>(
                     Mesh{require<std::int32_t>(triangles, "triangles", {-1, 3}),
                          require<std::int32_t>(corner_vert, "corner_vert", {-1}), std::nullopt,
                          vertex_count});
                 if (!corner_uv.is_none()) {
                     mesh->corner_uv =
                         require<float>(corner_uv, "corner_uv", {mesh->corner_vert.size(), 2});
                 }
                 validate(mesh->view());
                 return mesh;
             }),
             "triangles"_a, "corner_vert"_a, "corner_uv"_a, "vertex_count"_a)
        .def_property_readonly(
            "triangles", [](const Mesh& mesh) { return mesh.triangles; }, "int32[T, 3].")
        .def_property_readonly(
            "corner_vert", [](const Mesh& mesh) { return mesh.corner_vert; }, "int32[C].")
        .def_property_readonly(
            "corner_uv", [](const Mesh& mesh) { return mesh.corner_uv; }, "float32[C, 2] or None.")
        .def_readonly("vertex_count", &Mesh::vertex_count, "V.")
        .def_property_readonly(
            "tiles",
            [](const Mesh& mesh) {
                std::vector<std::pair<int, int>> result;
                for (const Tile& tile : tiles(mesh.view())) result.emplace_back(tile.u, tile.v);
                return result;
            },
            R"(The UV tiles that faces with UV area reach into, [(u, v), ...], sorted by (v, u).

Raises ValueError without a UV map, or for UVs beyond 1000 tiles.)");
    module.def(
        "udim", [](py::handle tile) { return udim(parse_tile(tile)); }, "tile"_a,
        "The UDIM number of a tile (u, v): 1001 + u + 10 v. Raises ValueError unless 0 <= u <= 9 "
        "and 0 <= v <= 99.");
}

}  // namespace ltmd::python
