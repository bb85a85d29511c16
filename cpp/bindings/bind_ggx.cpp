// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ggx.h"

#include <pybind11/stl.h>

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_ggx(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<GGX>;
    py::class_<Class, Distribution>(module, "GGX",
                                    R"(The GGX or Trowbridge-Reitz distribution.

alpha_x, alpha_y: slope scales along U and V in [1e-6, 1e6]; alpha_y = alpha_x if left out.
Source: masking-shadowing, eq. 71, 72, 85, 86.)")
        .def(py::init([](double x, std::optional<double> y) { return Class(x, y.value_or(x)); }),
             "alpha_x"_a, "alpha_y"_a = py::none())
        .def_property_readonly("alpha_x", [](const Class& c) { return c.exact.alpha_x(); })
        .def_property_readonly("alpha_y", [](const Class& c) { return c.exact.alpha_y(); })
        .def("__repr__", [](const Class& c) {
            return std::string(py::str("GGX({}, {})").format(c.exact.alpha_x(), c.exact.alpha_y()));
        });
}

}  // namespace ltmd::python
