// SPDX-License-Identifier: Apache-2.0
#include "bindings.h"
#include "ltmd/texel_coverage.h"

namespace ltmd::python {
namespace {

struct Report {
    RestReport counts;
    std::shared_ptr<const Mesh> mesh;
};

std::shared_ptr<PreparedRest> prepare_positions(const std::shared_ptr<const Mesh>& mesh,
                                                py::handle positions, const char* name) {
    const auto array = require<float>(positions, name, {-1, 3});
    const MeshView view = mesh->view();
    const auto points = items<Vec3f>(array);
    py::gil_scoped_release release;
    return std::make_shared<PreparedRest>(PreparedRest{mesh, RestState(view, points)});
}

}  // namespace

std::shared_ptr<const PreparedRest> prepare(const std::shared_ptr<const Mesh>& mesh,
                                            py::handle rest) {
    if (!py::isinstance<PreparedRest>(rest)) return prepare_positions(mesh, rest, "rest");
    auto prepared = rest.cast<std::shared_ptr<PreparedRest>>();
    if (prepared->mesh != mesh) throw py::value_error("rest was prepared for another mesh");
    return prepared;
}

void bind_rest_state(py::module_& module) {
    using namespace py::literals;
    py::class_<Report>(module, "RestReport", "What a rest state found in its mesh.")
        .def_property_readonly(
            "degenerate_triangles",
            [](const Report& report) { return report.counts.degenerate_triangles; },
            "Triangles without area at rest: their tension is the identity.")
        .def_property_readonly(
            "no_uv_triangles", [](const Report& report) { return report.counts.no_uv_triangles; },
            "Triangles without UV area: their tension is the identity.")
        .def_property_readonly(
            "mirrored_triangles",
            [](const Report& report) { return report.counts.mirrored_triangles; },
            "Triangles with negative UV area.")
        .def_property_readonly(
            "seam_vertices", [](const Report& report) { return report.counts.seam_vertices; },
            "Vertices whose faces fall into more than one UV fan.")
        .def_property_readonly(
            "overlap_fraction",
            [](const Report& report) {
                const MeshView view = report.mesh->view();
                py::gil_scoped_release release;
                return view.has_uv() ? overlap_fraction(view) : 0.0;
            },
            "The part of the covered UV area, 0 to 1, that more than one face covers; measured at "
            "1024 texels a tile when asked.")
        .def("__repr__", [](const Report& report) {
            return "RestReport(degenerate_triangles=" +
                   std::to_string(report.counts.degenerate_triangles) +
                   ", no_uv_triangles=" + std::to_string(report.counts.no_uv_triangles) +
                   ", mirrored_triangles=" + std::to_string(report.counts.mirrored_triangles) +
                   ", seam_vertices=" + std::to_string(report.counts.seam_vertices) + ")";
        });
    py::class_<PreparedRest, std::shared_ptr<PreparedRest>>(
        module, "RestState",
        R"(The rest state of a mesh, prepared once for any number of deformed states.

mesh: Mesh. positions: float32[V, 3] in the metric of the rendered object.
Holds R^-1 and the area of each triangle and the UV fan of each corner (microsurface-transformations, section 5.1).
Raises ValueError for another vertex count (both counts) or a position that is not finite (the first vertex is named).)")
        .def(py::init([](const std::shared_ptr<Mesh>& mesh, py::handle positions) {
                 return prepare_positions(mesh, positions, "positions");
             }),
             "mesh"_a, "positions"_a)
        .def_property_readonly(
            "report",
            [](const PreparedRest& rest) { return Report{rest.state.report(), rest.mesh}; },
            "RestReport: counts of degenerate, mirrored and seam elements.");
}

}  // namespace ltmd::python
