// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sheen.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_sheen(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<Sheen>;
    py::class_<Class, Distribution>(
        module, "Sheen",
        R"(The distribution of cloth D = (2 + 1/alpha) sin(theta)^(1/alpha) / (2 pi).

alpha: in [1e-3, 1]. Masking and visible normals by the tables of Tabulated.
Source: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF".)")
        .def(py::init<double>(), "alpha"_a)
        .def_property_readonly("alpha", [](const Class& c) { return c.exact.alpha(); })
        .def(
            "fitted_Lambda",
            [](const Class& self, py::handle v) {
                return for_each_direction(v, "v", [&](auto& w) {
                    const double cosine = w.z / length(w);
                    return static_cast<std::remove_cvref_t<decltype(w.z)>>(
                        sheen_lambda_fit(self.exact.alpha(), cosine));
                });
            },
            "v"_a,
            R"(Lambda as its authors fit it, for comparison: float[..., 3] -> float[...].

G1 is up to 11 % off for alpha >= 0.1, and more than twice too large at 0.01.)")
        .def("__repr__", [](const Class& c) {
            return std::string(py::str("Sheen({})").format(c.exact.alpha()));
        });
}

}  // namespace ltmd::python
