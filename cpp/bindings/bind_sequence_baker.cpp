// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sequence_baker.h"

#include <pybind11/stl.h>

#include "bindings.h"

namespace ltmd::python {
namespace {

struct Baker {
    std::shared_ptr<const PreparedRest> rest;
    SequenceBaker baker;
};

/// The baker's end waits for its writers; other Python threads run meanwhile.
struct Release {
    void operator()(Baker* baker) const {
        const auto rest = std::move(baker->rest);  // holds NumPy arrays: freed with the GIL
        py::gil_scoped_release release;
        delete baker;
    }
};

}  // namespace

void bind_sequence_baker(py::module_& module) {
    using namespace py::literals;
    py::class_<Baker, std::unique_ptr<Baker, Release>>(
        module, "SequenceBaker",
        R"(Bakes the frames of an animation into EXR files; compressing and writing overlap with the next frame.

mesh: Mesh with a UV map. rest: RestState, or float32[V, 3]. width, height: texels. passes: of ltmd.passes: 'tension'
(t11, t12, t22), 'stretch', 'wrinkle', 'alpha2' and 'roughness', each computed where `per` says and then interpolated.
alpha, M0, strength, height_response: the lobe of alpha2 and roughness, as in ltmd.alpha2.
margin: 0 to 64 texels. tile: (u, v). per: 'corner', 'vertex' or 'triangle'. compression, half, mantissa_bits: as in
ltmd.write_exr. metadata: header attributes of every file. in_flight: frames of pixels held at most, 1 to 16.
Files are RGBA, A = 1 (in the pass roughness A is data). Use as a context manager: leaving it finishes, or cancels after an exception.)")
        .def(py::init([](const std::shared_ptr<Mesh>& mesh, py::handle rest, int width, int height,
                         const std::vector<std::string>& passes, int margin, py::handle tile,
                         const std::string& per, const std::string& compression,
                         const py::dict& metadata, int in_flight, bool half,
                         std::optional<int> mantissa_bits, py::handle alpha, py::handle m0,
                         double strength, double height_response) {
                 const Precision precision = parse_precision(half, mantissa_bits);
                 const Lobe lobe = parse_lobe(alpha, m0, strength, height_response);
                 auto prepared = prepare(mesh, rest);
                 const SequenceOptions options{passes,
                                               margin,
                                               parse_tile(tile),
                                               parse_per(per),
                                               parse_compression(compression),
                                               parse_metadata(metadata),
                                               in_flight,
                                               precision,
                                               lobe};
                 const MeshView view = mesh->view();
                 py::gil_scoped_release release;
                 return std::unique_ptr<Baker, Release>(new Baker{
                     prepared, SequenceBaker(view, prepared->state, width, height, options)});
             }),
             "mesh"_a, "rest"_a, "width"_a, "height"_a,
             "passes"_a = std::vector<std::string>{"tension"}, py::kw_only(), "margin"_a = 16,
             "tile"_a = py::make_tuple(0, 0), "per"_a = "corner", "compression"_a = "zip",
             "metadata"_a = py::dict(), "in_flight"_a = 2, "half"_a = false,
             "mantissa_bits"_a = py::none(), "alpha"_a = 0.5, "M0"_a = py::none(),
             "strength"_a = 1.0, "height_response"_a = 0.0)
        .def(
            "frame",
            [](Baker& self, py::handle deformed, const py::dict& paths, const py::dict& metadata,
               py::handle rest) {
                const auto positions = require<float>(deformed, "deformed", {-1, 3});
                std::map<std::string, std::string> files;
                for (const auto& [pass, path] : paths)
                    files[pass.cast<std::string>()] = parse_path(path);
                const Metadata attributes = parse_metadata(metadata);
                const auto points = items<Vec3f>(positions);
                const auto prepared = rest.is_none() ? self.rest : prepare(self.rest->mesh, rest);
                py::gil_scoped_release release;
                self.baker.frame(prepared->state, points, files, attributes);
            },
            "deformed"_a, "paths"_a, "metadata"_a = py::dict(), py::kw_only(),
            "rest"_a = py::none(),
            R"(Measure float32[V, 3] and queue one file per pass: paths = {pass: path}. Returns once queued; waits while in_flight frames are unwritten.

rest: RestState of the same mesh, or float32[V, 3], instead of the baker's own. Raises ValueError for bad input, OSError that a writer met earlier, ltmd.Cancelled after cancel().)")
        .def(
            "cancel", [](Baker& self) { self.baker.cancel(); },
            py::call_guard<py::gil_scoped_release>(),
            "Drop queued files; complete files stay, none is left half-written.")
        .def(
            "finish", [](Baker& self) { self.baker.finish(); },
            py::call_guard<py::gil_scoped_release>(),
            "Wait until every file is written. Raises the first OSError that a writer met.")
        .def_property_readonly(
            "progress",
            [](const Baker& self) {
                return std::pair(self.baker.files_written(), self.baker.files_submitted());
            },
            "(files written, files submitted).")
        .def_property_readonly(
            "coverage_report",
            [](const Baker& self) {
                return py::dict("covered"_a = self.baker.coverage().covered(),
                                "overlapping"_a = self.baker.coverage().overlapping());
            },
            "{'covered': texel centres in a face, 'overlapping': those in more than one}.")
        .def("__enter__", [](py::object self) { return self; })
        .def("__exit__", [](Baker& self, py::handle type, py::handle, py::handle) {
            const bool failed = !type.is_none();
            py::gil_scoped_release release;
            if (failed)
                self.baker.cancel();
            else
                self.baker.finish();
        });
    module.attr("passes") =
        py::cast(std::vector<std::string>(pass_names().begin(), pass_names().end()));
}

}  // namespace ltmd::python
