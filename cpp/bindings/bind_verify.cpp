// SPDX-License-Identifier: Apache-2.0
#include "ltmd/verify.h"

#include <pybind11/stl.h>

#include "bindings.h"

namespace ltmd::python {

void bind_verify(py::module_& module) {
    using namespace py::literals;
    py::class_<VerifyReport>(module, "VerifyReport", "What ltmd.verify found.")
        .def_property_readonly("ok", &VerifyReport::ok, "True when there is no problem.")
        .def_readonly("problems", &VerifyReport::problems,
                      "One sentence each, naming the file or frame.")
        .def_readonly("sequences", &VerifyReport::sequences, "{sequence name: its frames, sorted}.")
        .def("__repr__", [](const VerifyReport& report) {
            return "VerifyReport(ok=" + std::string(report.ok() ? "True" : "False") +
                   ", problems=" + std::to_string(report.problems.size()) +
                   ", sequences=" + std::to_string(report.sequences.size()) + ")";
        });
    module.def(
        "verify",
        [](py::handle directory, const std::optional<std::vector<int>>& frames,
           const std::optional<std::vector<std::string>>& sequences) {
            const std::string folder = parse_path(directory);
            py::gil_scoped_release release;
            return verify(folder, frames.value_or(std::vector<int>{}),
                          sequences.value_or(std::vector<std::string>{}));
        },
        "directory"_a, "frames"_a = py::none(), "sequences"_a = py::none(),
        R"(Check baked sequences in a folder -> VerifyReport.

Every frame present (a missing one would render as the identity), one size, finite, tension's diagonal in [1e-3, 1e3],
A = 1, one convention. frames: those expected, the only ones looked at; by default the range that the files state.
sequences: names such as 'balloon_tension' or 'balloon_tension.1001'; by default all. Raises OSError for an unreadable folder.)");
}

}  // namespace ltmd::python
