// SPDX-License-Identifier: Apache-2.0
#include "ltmd/beckmann.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_beckmann(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<Beckmann>;
    py::class_<Class, Distribution>(module, "Beckmann",
                                    R"(The Beckmann distribution: Gaussian slopes.

alpha_x, alpha_y: slope scales along U and V in [1e-6, 1e6], sqrt(2) times the standard deviations; alpha_y = alpha_x if left
out. Lambda is exact; for the usual fit see beckmann_lambda_rational. Source: masking-shadowing, eq. 67-69, 81-83.)")
        .def(py::init([](double x, std::optional<double> y) { return Class(x, y.value_or(x)); }),
             "alpha_x"_a, "alpha_y"_a = py::none())
        .def_property_readonly("alpha_x", [](const Class& c) { return c.exact.alpha_x(); })
        .def_property_readonly("alpha_y", [](const Class& c) { return c.exact.alpha_y(); })
        .def("__repr__", [](const Class& c) {
            return std::string(
                py::str("Beckmann({}, {})").format(c.exact.alpha_x(), c.exact.alpha_y()));
        });
    module.def(
        "beckmann_lambda_rational", py::vectorize(beckmann_lambda_rational<double>), "a"_a,
        R"(A rational fit of the Beckmann distribution's Lambda at a = 1 / (alpha tan(theta)) > 0, 0 from 1.6 on.

G1 = 1 / (1 + Lambda) is up to 0.33 % off. Source: masking-shadowing, after eq. 69.)");
}

}  // namespace ltmd::python
