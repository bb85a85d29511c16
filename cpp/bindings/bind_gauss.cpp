// SPDX-License-Identifier: Apache-2.0
#include "ltmd/gauss.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_gauss(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<Gauss>;
    py::class_<Class, Distribution>(
        module, "Gauss",
        R"(Torrance and Sparrow's Gauss distribution, D proportional to exp(-theta^2 / m^2), normalised exactly.

m: in [1e-6, 2]. Masking and samples by the tables of Tabulated.
Source: microfacet-distribution-conversion, Table 1, whose normalisation is approximate.)")
        .def(py::init<double>(), "m"_a)
        .def_property_readonly("m", [](const Class& c) { return c.exact.m(); })
        .def("__repr__",
             [](const Class& c) { return std::string(py::str("Gauss({})").format(c.exact.m())); });
}

}  // namespace ltmd::python
