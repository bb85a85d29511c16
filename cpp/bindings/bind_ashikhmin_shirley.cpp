// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ashikhmin_shirley.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_ashikhmin_shirley(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<AshikhminShirley>;
    py::class_<Class, Distribution>(module, "AshikhminShirley",
                                    R"(Ashikhmin and Shirley's anisotropic Phong distribution.

D = sqrt((nx + 2) (ny + 2)) / (2 pi) cos(theta)^(nx cos^2(phi) + ny sin^2(phi)), of which D cos integrates to 1.
nx, ny: exponents along U and V, in [0.01, 1e13]. Masking and visible normals by tables, within 1e-5.
Source: microfacet-distribution-conversion, Table 1.)")
        .def(py::init<double, double>(), "nx"_a, "ny"_a)
        .def_property_readonly("nx", [](const Class& c) { return c.exact.nx(); })
        .def_property_readonly("ny", [](const Class& c) { return c.exact.ny(); })
        .def("__repr__", [](const Class& c) {
            return std::string(
                py::str("AshikhminShirley({}, {})").format(c.exact.nx(), c.exact.ny()));
        });
}

}  // namespace ltmd::python
