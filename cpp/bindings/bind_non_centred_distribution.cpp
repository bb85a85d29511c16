// SPDX-License-Identifier: Apache-2.0
#include "ltmd/non_centred_distribution.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {
namespace {

template <class Real>
using Sheared = NonCentredDistribution<AnyDistribution<Real>>;

/// A distribution sheared vertically, in Python.
struct NonCentred : Distribution {
    NonCentred(py::object of, const Slope<double>& offset)
        : NonCentred(std::move(of), {of.cast<const Distribution&>().single, offset},
                     {of.cast<const Distribution&>().full, offset}) {}

    py::object base;
    Sheared<float> exact_single;
    Sheared<double> exact;

    const Sheared<float>& exact_of(float) const { return exact_single; }
    const Sheared<double>& exact_of(double) const { return exact; }

private:
    NonCentred(py::object of, Sheared<float> f, Sheared<double> d)
        : Distribution{AnyDistribution<float>(f), AnyDistribution<double>(d)},
          base(std::move(of)),
          exact_single(std::move(f)),
          exact(std::move(d)) {}
};

}  // namespace

void bind_non_centred_distribution(py::module_& module) {
    using namespace py::literals;
    module.def(
        "correlated_stretch",
        [](double x, double y, double r) { return matrix_array(correlated_stretch(x, y, r)); },
        "alpha_x"_a, "alpha_y"_a, "r_xy"_a,
        R"(The symmetric M, float64[2, 2], under which GGX(1) or Beckmann(1) gets alpha_x, alpha_y with correlation r_xy.

M = Q^(1/2) with Q^-1 = [[alpha_x^2, r_xy alpha_x alpha_y], [., alpha_y^2]]; alphas in [1e-6, 1e6], -1 < r_xy < 1.
Source: masking-shadowing, eq. 88.)");
    py::class_<Distribution>(module.attr("Distribution"))
        .def(
            "sheared", [](py::object self, double x, double y) { return NonCentred(self, {x, y}); },
            "slope_x"_a, "slope_y"_a,
            R"(This distribution with every slope moved by (slope_x, slope_y), each in [-1e6, 1e6]: a vertical shear of its surface.

Source: masking-shadowing, eq. 94-97.)");
    py::class_<NonCentred, Distribution>(
        module, "NonCentredDistribution",
        R"(A centred distribution with its mean slope moved to `offset`, a vertical shear of its surface.

Lambda and G1 hold the ratio of the mesosurface's to the macrosurface's projected area; where less than v_z faces v, G1 is 1
and the weak white furnace gives less than 1. Source: masking-shadowing, section 5.5.)")
        .def_readonly("base", &NonCentred::base)
        .def_property_readonly(
            "offset",
            [](const NonCentred& d) { return std::pair(d.exact.offset().x, d.exact.offset().y); })
        .def(
            "mesosurface_area",
            [](const NonCentred& d, py::handle v) {
                return for_each_direction(
                    v, "v", [&](auto& w) { return d.exact_of(w.z).mesosurface_area(w); });
            },
            "v"_a,
            R"(The visible projected area (w_m.v)/(w_m.n), w_m the mean normal; 0 if it faces away: float[..., 3] -> float[...].

Source: masking-shadowing, section 5.5.)")
        .def(
            "mesosurface_G1",
            [](const NonCentred& d, py::handle v) {
                return for_each_direction(
                    v, "v", [&](auto& w) { return d.exact_of(w.z).mesosurface_G1(w); });
            },
            "v"_a,
            R"(The base's masking at the slope of v less the offset, in [0, 1]; 0 if the mean normal or v_z faces away: float[..., 3] -> float[...].

Source: masking-shadowing, eq. 96.)")
        .def(
            "sheared",
            [](const NonCentred& d, double x, double y) {
                return NonCentred(d.base, {d.exact.offset().x + x, d.exact.offset().y + y});
            },
            "slope_x"_a, "slope_y"_a, "The base with both offsets.")
        .def("__repr__", [](const NonCentred& d) {
            return std::string(py::repr(d.base)) +
                   std::string(
                       py::str(".sheared({}, {})").format(d.exact.offset().x, d.exact.offset().y));
        });
}

}  // namespace ltmd::python
