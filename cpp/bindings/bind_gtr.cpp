// SPDX-License-Identifier: Apache-2.0
#include "ltmd/gtr.h"

#include "bindings.h"
#include "lobes.h"

namespace ltmd::python {
namespace {

GTRMasking parse_masking(const std::string& name) {
    if (name == "exact") return GTRMasking::exact;
    if (name == "spline") return GTRMasking::spline;
    throw py::value_error("masking must be 'exact' or 'spline', not '" + name + "'");
}
const char* masking_name(GTRMasking masking) {
    return masking == GTRMasking::exact ? "exact" : "spline";
}

}  // namespace

void bind_gtr(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<GTR>;
    py::class_<Class, Distribution> c(module, "GTR",
                                      R"(The Generalized Trowbridge-Reitz distribution.

alpha: the slope scale in [1e-4, 1]; gamma: the tails in [0, 4], 2 is GGX and less has longer tails. masking "exact" is Smith's of
the distribution; "spline" is the published approximation, which between integer gamma breaks the weak white furnace: by 2 % at
alpha 0.16, by tens of per cent at alpha 0.01. Source: microsurface-transformations, eq. 32, 33 and appendix A.)");
    c.def(py::init([](double alpha, double gamma, const std::string& masking) {
              return Class(alpha, gamma, parse_masking(masking));
          }),
          "alpha"_a, "gamma"_a, "masking"_a = "exact")
        .def_property_readonly("alpha", [](const Class& self) { return self.exact.alpha(); })
        .def_property_readonly("gamma", [](const Class& self) { return self.exact.gamma(); })
        .def_property_readonly("masking",
                               [](const Class& self) { return masking_name(self.exact.masking()); })
        .def_property_readonly(
            "lobes",
            [](const Class& self) {
                const double alpha = self.exact.alpha(), gamma = self.exact.gamma();
                return Mixture(gamma <= 2 ? gtr_ggx_lobes(alpha, gamma, 40)
                                          : gtr_beckmann_lobes(alpha, gamma, 64));
            },
            "As an exact mixture, by quadrature: at most 40 GGX lobes, for gamma > 2 64 Beckmann "
            "lobes; see fit_lobes for few.")
        .def(
            "sample_mixed",
            [](const Class& self, py::handle v, py::handle u, py::handle out) {
                return over_views<Uniform, true>(v, u, "u", out,
                                                 [&](auto real, auto a, auto b, auto to) {
                                                     self.exact_of(real).sample_mixed(a, b, to);
                                                 });
            },
            "v"_a, "u"_a, py::kw_only(), "out"_a = py::none(),
            R"(Normals that reflect v uniformly with the probability alpha, else those of sample(): float[..., 3], float[..., 2] -> float[..., 3].

Source: microsurface-transformations, appendix B, which leaves the probability open.)")
        .def(
            "pdf_mixed",
            [](const Class& self, py::handle v, py::handle m, py::handle out) {
                return over_views<Direction, false>(v, m, "m", out,
                                                    [&](auto real, auto a, auto b, auto to) {
                                                        self.exact_of(real).pdf_mixed(a, b, to);
                                                    });
            },
            "v"_a, "m"_a, py::kw_only(), "out"_a = py::none(),
            "The density of sample_mixed(), of both ways, per steradian: float[..., 3], "
            "float[..., 3] -> float[...].")
        .def("__repr__", [](const Class& self) {
            return std::string(py::str("GTR({}, {}, masking='{}')")
                                   .format(self.exact.alpha(), self.exact.gamma(),
                                           masking_name(self.exact.masking())));
        });
    bind_bounded(c);
}

}  // namespace ltmd::python
