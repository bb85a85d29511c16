// SPDX-License-Identifier: Apache-2.0
#include "ltmd/mdf_conversion.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_mdf_conversion(py::module_& module) {
    using namespace py::literals;
    py::tuple names(mdf_method_names.size());
    for (std::size_t i = 0; i < mdf_method_names.size(); ++i) names[i] = mdf_method_names[i];
    module.attr("MDF_METHODS") = names;
    module.def(
        "convert",
        [](py::handle value, const std::string& source, const std::string& target,
           const std::string& method, double gamma) -> py::object {
            const MdfConversion conversion(parse_mdf_parameter(source), parse_mdf_parameter(target),
                                           parse_mdf_method(method), gamma);
            const py::array given = floating(value, "value");
            const auto values =
                py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
            Array<double> out(
                std::vector<py::ssize_t>(values.shape(), values.shape() + values.ndim()));
            {
                const auto from = items<double>(Array<double>(values));
                const auto to = mutable_items<double>(out);
                py::gil_scoped_release release;
                conversion(from, to);
            }
            if (values.ndim() == 0) return py::float_(*out.data());
            return out.attr("astype")(given.dtype(), "copy"_a = false);
        },
        "value"_a, "source"_a, "target"_a, "method"_a = "rmse", "gamma"_a = 2.0,
        R"(The value of a roughness parameter that looks most like `value` of another: float[...] -> float[...].

source, target: of MDF_PARAMETERS. An anisotropic distribution is converted an axis at a time:
convert([N_x, N_y], "ashikhmin_shirley_n", "ggx_alpha") is [alpha_x, alpha_y].
method: "rmse", the least root mean square difference of D/D(0) from Beckmann's over angles in [0, min(4 m_B, pi/2)], any pair;
"half_angle", the same angle where D/D(0) is 1/2, any pair; "closed_form", the paper's formulas for rmse, without gtr_alpha,
m_B up to 0.45; "ward", m_B^2 N = 2, beckmann_alpha and phong_exponent only.
gamma: of gtr_alpha, in [0.5, 16], else unused. There and back is the same value, but for closed_form.
Raises ValueError for other names, with the list; a pair that the method lacks; or a value outside its range, with the range.
Source: microfacet-distribution-conversion, eq. 3-15, Tables 2-4.)");
    module.def(
        "fit_mdf",
        [](double value, const std::string& source, const std::string& target, double largest_angle,
           double gamma) {
            const MdfFit fit = fit_mdf(parse_mdf_parameter(source), value,
                                       parse_mdf_parameter(target), largest_angle, gamma);
            return py::make_tuple(fit.value, fit.rmse);
        },
        "value"_a, "source"_a, "target"_a, "largest_angle"_a, "gamma"_a = 2.0,
        R"((value, rmse): the `target`, in its range, whose D/D(0) is nearest to that of `source` = `value`, and the root mean square difference.

largest_angle: radians in (0, pi/2]; the mean is over [0, largest_angle]. Other arguments and errors as convert.
Source: microfacet-distribution-conversion, Table 2, where the source is beckmann_alpha.)");
}

}  // namespace ltmd::python
