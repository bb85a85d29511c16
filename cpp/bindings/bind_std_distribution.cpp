// SPDX-License-Identifier: Apache-2.0
#include "ltmd/std_distribution.h"

#include <pybind11/numpy.h>

#include "bindings.h"
#include "distributions.h"
#include "ltmd/phong.h"

namespace ltmd::python {

void bind_std_distribution(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<STD>;
    py::class_<Class, Distribution>(
        module, "STD",
        R"(Student's t-distribution of slopes: GGX at gamma = 2, Beckmann for gamma to infinity.

alpha: slope scale in [1e-6, 1e6]; gamma: in [1.51, 1e9], not that of GTR. Lambda is exact; for the published fit see
std_lambda_rational. Source: Ribardiere et al. 2017 (doi 10.1111/cgf.13137).)")
        .def(py::init<double, double>(), "alpha"_a, "gamma"_a)
        .def_property_readonly("alpha", [](const Class& c) { return c.exact.alpha(); })
        .def_property_readonly("gamma", [](const Class& c) { return c.exact.gamma(); })
        .def("__repr__", [](const Class& c) {
            return std::string(py::str("STD({}, {})").format(c.exact.alpha(), c.exact.gamma()));
        });
    module.def(
        "std_lambda_rational", py::vectorize(std_lambda_rational), "a"_a, "gamma"_a,
        R"(The published fit of STD's Lambda at a = 1 / (alpha tan(theta)) > 0, for gamma in (1.5, 40].

G1 = 1 / (1 + Lambda) is up to 0.7 % off. Source: Ribardiere et al. 2017, eq. 13, 14, 22, 23.)");
}

void bind_phong(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<Phong>;
    py::class_<Class, Distribution>(
        module, "Phong",
        R"(The Phong distribution, D = (exponent + 2) / (2 pi) cos^exponent, with its exact masking.

exponent: in [0, 1e9]. It is STD(sqrt(2 / (exponent + 2)), exponent / 2 + 2). Usually it is masked by
beckmann_lambda_rational at alpha = sqrt(2 / (exponent + 2)): G1 is up to 77 % off at exponent 0, 7 % at 10, 0.9 % at 100.)")
        .def(py::init<double>(), "exponent"_a)
        .def_property_readonly("exponent", [](const Class& c) { return c.exact.exponent(); })
        .def("__repr__", [](const Class& c) {
            return std::string(py::str("Phong({})").format(c.exact.exponent()));
        });
}

}  // namespace ltmd::python
