// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sawicki_ds.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_sawicki_ds(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<SawickiDS>;
    py::class_<Class, Distribution>(module, "SawickiDS",
                                    R"(Sawicki's rational approximation D_DS of Beckmann.

N: its parameter N_DS, in [0.01, 1e13]. Masking and visible normals by the tables of Tabulated.
Source: microfacet-distribution-conversion, Table 1.)")
        .def(py::init<double>(), "N"_a)
        .def_property_readonly("N", [](const Class& c) { return c.exact.N(); })
        .def("__repr__", [](const Class& c) {
            return std::string(py::str("SawickiDS({})").format(c.exact.N()));
        });
}

}  // namespace ltmd::python
