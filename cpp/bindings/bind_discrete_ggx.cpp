// SPDX-License-Identifier: Apache-2.0
#include "ltmd/discrete_ggx.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {
namespace {

/// DiscreteGGX's parameters, for those who ask.
struct Discrete : Bound<DiscreteGGX> {
    Discrete(double alpha_, double facets_, double cone_, std::uint64_t seed_)
        : Bound(std::make_shared<const DiscreteFacets>(alpha_, facets_, cone_, seed_)),
          alpha(alpha_),
          cone(cone_),
          facets(static_cast<std::uint64_t>(facets_)),
          seed(seed_) {}

    double alpha, cone;
    std::uint64_t facets, seed;
};

}  // namespace

void bind_discrete_ggx(py::module_& module) {
    using namespace py::literals;
    py::class_<Discrete, Distribution>(
        module, "DiscreteGGX",
        R"(Facets drawn from GGX, each a uniform cap of normals: glints of a surface with few mirrors.

alpha: of the GGX, in [1e-6, 1e6]; facets: a whole number in [1, 1e7]; cone: the caps' half-angle in [1e-3, 1] radians;
seed: a whole number, the same facets for the same seed. All facets have one projected area and lie above the horizon, so
D cos integrates to 1. Everything is exact for this realisation.
Source: microsurface-transformations, section 4.3 (after Jakob et al. 2014).)")
        .def(py::init<double, double, double, std::uint64_t>(), "alpha"_a, "facets"_a, "cone"_a,
             "seed"_a = 0)
        .def_readonly("alpha", &Discrete::alpha)
        .def_readonly("facets", &Discrete::facets)
        .def_readonly("cone", &Discrete::cone)
        .def_readonly("seed", &Discrete::seed)
        .def_property_readonly(
            "normals",
            [](const Discrete& self) {
                const auto& normals = self.exact.facets().normals();
                Array<double> out({static_cast<py::ssize_t>(normals.size()), py::ssize_t{3}});
                std::ranges::copy(normals, mutable_items<Direction<double>>(out).begin());
                return out;
            },
            "The axes of the caps: float64[facets, 3].")
        .def("__repr__", [](const Discrete& d) {
            return std::string(
                py::str("DiscreteGGX({}, {}, {}, {})").format(d.alpha, d.facets, d.cone, d.seed));
        });
}

}  // namespace ltmd::python
