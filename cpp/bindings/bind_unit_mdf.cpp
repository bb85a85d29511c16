// SPDX-License-Identifier: Apache-2.0
#include "ltmd/unit_mdf.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {

void bind_unit_mdf(py::module_& module) {
    using namespace py::literals;
    py::tuple names(mdf_parameters.size());
    for (std::size_t i = 0; i < mdf_parameters.size(); ++i) names[i] = mdf_parameters[i].name;
    module.attr("MDF_PARAMETERS") = names;
    module.def(
        "unit_mdf",
        [](const std::string& name, double value, py::handle beta, double gamma) -> py::object {
            const MdfParameter parameter = parse_mdf_parameter(name);
            const py::array angles = floating(beta, "beta");
            unit_mdf(parameter, value, 0, gamma);  // refuses also where there are no angles
            return by_dtype(angles, [&](auto real) -> py::object {
                using Real = decltype(real);
                const auto from = Array<Real>::ensure(angles);
                Array<Real> to(std::vector<py::ssize_t>(from.shape(), from.shape() + from.ndim()));
                for (py::ssize_t i = 0; i < from.size(); ++i)
                    to.mutable_data()[i] = static_cast<Real>(
                        unit_mdf(parameter, value, static_cast<double>(from.data()[i]), gamma));
                return to;
            });
        },
        "parameter"_a, "value"_a, "beta"_a, "gamma"_a = 2.0,
        R"(D(beta) / D(0) of the microfacet distribution that `parameter`, one of MDF_PARAMETERS, describes: float[...] -> float[...].

beta: radians from the normal; 0 for |beta| >= pi/2. gamma: of gtr_alpha, in [0.5, 16], else unused.
Raises ValueError for another name, with the list, or a value outside its range, with the range.
Source: microfacet-distribution-conversion, Table 1.)");
}

}  // namespace ltmd::python
