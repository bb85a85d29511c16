// SPDX-License-Identifier: Apache-2.0
#include "ltmd/smith_masking.h"

#include <pybind11/functional.h>

#include "bindings.h"

namespace ltmd::python {
namespace {

using Function = std::function<double(double)>;

/// integral(function, x) for every x of an array.
template <class Integral>
Array<double> for_each_number(const Integral& integral, const Function& function,
                              const py::array_t<double>& x) {
    const Array<double> in = Array<double>::ensure(x);
    Array<double> out(std::vector<py::ssize_t>(in.shape(), in.shape() + in.ndim()));
    for (py::ssize_t i = 0; i < in.size(); ++i)
        out.mutable_data()[i] = integral(function, in.data()[i]);
    return out;
}

}  // namespace

void bind_smith_masking(py::module_& module) {
    using namespace py::literals;
    module.def(
        "smith_lambda",
        [](const Function& slopes, const py::array_t<double>& cotangent) {
            return for_each_number(smith_lambda, slopes, cotangent);
        },
        "slopes"_a, "cotangent"_a,
        R"(Smith's Lambda for the density of slopes along the view's azimuth: function, float[...] -> float64[...].

slopes(slope) integrates to 1 over all slopes; cotangent > 0: of the angle between view and normal. By quadrature; ValueError
where the integral does not converge. Source: masking-shadowing, eq. 124.)");
    module.def(
        "smith_lambda_of_shape",
        [](const Function& shape, const py::array_t<double>& a) {
            return for_each_number(smith_lambda_of_shape, shape, a);
        },
        "shape"_a, "a"_a,
        R"(Smith's Lambda of every distribution P22 = f(|slope| / alpha) / alpha^2, also stretched: function, float[...] -> float64[...].

shape(r): the density of slopes at the distance r, for alpha = 1. a = 1 / (alpha_o tan theta_o) > 0, alpha_o the roughness
projected onto the view's azimuth. ValueError where the integral does not converge. Source: masking-shadowing, eq. 65, 79, 80.)");
    module.def(
        "shape_integral", &shape_integral, "shape"_a,
        R"(The integral of shape(|slope|) over all slopes, by which to divide it: function -> float.

ValueError where it does not converge. Source: masking-shadowing, eq. 87.)");
}

}  // namespace ltmd::python
