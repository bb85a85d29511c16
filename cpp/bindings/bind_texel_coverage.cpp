// SPDX-License-Identifier: Apache-2.0
#include "ltmd/texel_coverage.h"

#include <pybind11/stl.h>

#include "bindings.h"
#include "ltmd/bake.h"

namespace ltmd::python {
namespace {

Array<float> bake_values(const TexelCoverage& coverage, py::handle corner_values,
                         const std::vector<float>& background) {
    const auto values = require<float>(corner_values, "corner_values",
                                       {static_cast<py::ssize_t>(coverage.corner_count()), -1});
    const int channels = static_cast<int>(values.shape(1));
    Array<float> out({static_cast<py::ssize_t>(coverage.height()),
                      static_cast<py::ssize_t>(coverage.width()), values.shape(1)});
    const auto from = items<float>(values);
    const auto to = mutable_items<float>(out);
    py::gil_scoped_release release;
    bake(coverage, from, channels, background, channels, to);
    return out;
}

}  // namespace

void bind_texel_coverage(py::module_& module) {
    using namespace py::literals;
    const std::vector<float> identity(identity_tension.begin(), identity_tension.end());
    py::class_<TexelCoverage>(
        module, "TexelCoverage",
        R"(Which triangle each texel of a UV tile belongs to: computed once, used for every frame.

mesh: Mesh with a UV map. width, height: 1 to 65536 texels. tile: (u, v). margin: 0 to 64 texels past each chart's border.
A texel takes the triangle under its centre (the lowest index where faces overlap); a texel that faces only touch, and the
margin, take the nearest point of the nearest face of this UV layout. Raises ValueError outside these ranges.)")
        .def(py::init([](const Mesh& mesh, int width, int height, py::handle tile, int margin) {
                 const Tile where = parse_tile(tile);
                 const MeshView view = mesh.view();
                 py::gil_scoped_release release;
                 return TexelCoverage(view, width, height, where, margin);
             }),
             "mesh"_a, "width"_a, "height"_a, "tile"_a = py::make_tuple(0, 0), "margin"_a = 16)
        .def("bake", &bake_values, "corner_values"_a, "background"_a = identity,
             "As ltmd.bake, with this coverage.")
        .def_property_readonly("width", &TexelCoverage::width)
        .def_property_readonly("height", &TexelCoverage::height)
        .def_property_readonly("covered", &TexelCoverage::covered,
                               "Texel centres in at least one face.")
        .def_property_readonly("overlapping", &TexelCoverage::overlapping,
                               "Texel centres strictly inside more than one face.")
        .def_property_readonly(
            "triangle",
            [](const TexelCoverage& coverage) {
                Array<std::int32_t> out({static_cast<py::ssize_t>(coverage.height()),
                                         static_cast<py::ssize_t>(coverage.width())});
                std::int32_t* to = out.mutable_data();
                for (const CoverageTexel& texel : coverage.texels()) *to++ = texel.triangle;
                return out;
            },
            "int32[height, width], row 0 = top: each texel's triangle, -1 for the background.");
    module.def(
        "bake",
        [](const Mesh& mesh, py::handle corner_values, int width, int height, py::handle tile,
           int margin, const std::vector<float>& background) {
            const Tile where = parse_tile(tile);
            const MeshView view = mesh.view();
            const auto coverage = [&] {
                py::gil_scoped_release release;
                return TexelCoverage(view, width, height, where, margin);
            }();
            return bake_values(coverage, corner_values, background);
        },
        "mesh"_a, "corner_values"_a, "width"_a, "height"_a, "tile"_a = py::make_tuple(0, 0),
        "margin"_a = 16, "background"_a = identity,
        R"(Per-corner values as a texture: float32[C, k] -> float32[height, width, k], row 0 = top.

Each texel takes the barycentric mean at its centre; texels no face reaches take `background` (k values; the identity, never
black). tile: (u, v); margin: 0 to 64 texels. Raises ValueError for other sizes or a mesh without a UV map.)");
}

}  // namespace ltmd::python
