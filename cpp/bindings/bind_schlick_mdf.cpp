// SPDX-License-Identifier: Apache-2.0
#include "ltmd/schlick_mdf.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_schlick_mdf(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<SchlickMDF>;
    py::class_<Class, Distribution>(
        module, "SchlickMDF",
        R"(Schlick's rational approximation of Beckmann; 0 where cos(theta) < 1 - m.

m: Beckmann's, in [1e-6, 1]. Masking and visible normals by the tables of Tabulated.
Source: microfacet-distribution-conversion, Table 1.)")
        .def(py::init<double>(), "m"_a)
        .def_property_readonly("m", [](const Class& c) { return c.exact.m(); })
        .def("__repr__", [](const Class& c) {
            return std::string(py::str("SchlickMDF({})").format(c.exact.m()));
        });
}

}  // namespace ltmd::python
