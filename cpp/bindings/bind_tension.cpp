// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tension.h"

#include "bindings.h"

namespace ltmd::python {

Per parse_per(const std::string& name) {
    if (name == "triangle") return Per::triangle;
    if (name == "vertex") return Per::vertex;
    if (name == "corner") return Per::corner;
    throw py::value_error("per is '" + name + "'; it must be 'triangle', 'vertex' or 'corner'");
}

void bind_tension(py::module_& module) {
    using namespace py::literals;
    module.def(
        "tension",
        [](const std::shared_ptr<Mesh>& mesh, py::handle rest, py::handle deformed,
           const std::string& per) {
            const Per where = parse_per(per);
            const auto positions = require<float>(deformed, "deformed", {-1, 3});
            const auto prepared = prepare(mesh, rest);
            Array<float> out(
                {static_cast<py::ssize_t>(tension_count(prepared->state, where)), py::ssize_t{3}});
            const auto points = items<Vec3f>(positions);
            const auto values = mutable_items<Tension>(out);
            py::gil_scoped_release release;
            tension(prepared->state, points, where, values);
            return out;
        },
        "mesh"_a, "rest"_a, "deformed"_a, "per"_a = "corner",
        R"(The tension matrix T = D R^-1 as float32[n, 3] (t11, t12, t22), dimensionless; T = [[t11, t12], [0, t22]].

mesh: Mesh with a UV map. rest: RestState, or float32[V, 3]. deformed: float32[V, 3], in the metric of the rendered object.
per: 'triangle' (n = T), 'corner' (n = C; mean over the corner's UV fan, weighted by rest area, never across UV seams or
mirrored UVs) or 'vertex' (n = V; mean over all faces of the vertex).
Degenerate: a rest triangle without area or UV area gives (1, 0, 1); stretches are clamped to [1e-3, 1e3].
Raises ValueError for other counts or a position that is not finite (the first vertex is named), TypeError for another dtype.
Source: microsurface-transformations, section 5.1, Fig. 7.)");
    module.def(
        "tension_matrix",
        [](py::handle t) {
            const auto values = require<float>(t, "t", {3}, true);
            Array<float> out = empty_like_leading(values, {2, 2});
            tension_matrix(items<Tension>(values), mutable_items<std::array<float, 4>>(out));
            return out;
        },
        "t"_a, "The row-major matrices float32[..., 2, 2] of tensions t: float32[..., 3].");
    module.def(
        "stretch",
        [](py::handle t) {
            const auto values = require<float>(t, "t", {3}, true);
            Array<float> out = empty_like_leading(values, {3});
            const auto from = items<Tension>(values);
            const auto to = mutable_items<Vec3f>(out);
            py::gil_scoped_release release;
            stretch(from, to);
            return out;
        },
        "t"_a,
        R"((largest principal stretch, smallest, area ratio) of tensions t: float32[..., 3] -> float32[..., 3].

Needs no frame: the same on both sides of a UV seam. At rest (1, 1, 1).)");
}

}  // namespace ltmd::python
