// SPDX-License-Identifier: Apache-2.0
#include "ltmd/height_masking.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {
namespace {

Heights parse_heights(const std::string& name) {
    if (name == "uniform") return Heights::uniform;
    if (name == "gaussian") return Heights::gaussian;
    throw py::value_error("heights must be 'uniform' or 'gaussian', not '" + name + "'");
}

/// function(fraction below h, directions...) for each item; h is the last argument.
template <std::size_t... I, class Function>
py::object over_heights(std::index_sequence<I...>, const std::vector<Argument>& arguments,
                        Heights heights, const Function& function) {
    const auto arrays = broadcast(arguments);
    return by_dtype(arrays[0], [&](auto real) -> py::object {
        using Real = decltype(real);
        const std::vector<Array<Real>> given{
            require<Real>(arrays[I], arguments[I].name, {3}, true)...};
        const Array<Real> h = Array<Real>::ensure(arrays.back());
        const std::array directions{items<ltmd::Direction<Real>>(given[I])...};
        Array<Real> out(std::vector<py::ssize_t>(h.shape(), h.shape() + h.ndim()));
        const auto from = items<Real>(h);
        const auto to = mutable_items<Real>(out);
        py::gil_scoped_release release;
        for (std::size_t j = 0; j < to.size(); ++j)
            to[j] = function(fraction_below(heights, from[j]), directions[I][j]...);
        return out;
    });
}

}  // namespace

void bind_height_masking(py::module_& module) {
    using namespace py::literals;
    module.def(
        "G1_at_height",
        [](const Distribution& d, py::handle v, py::handle m, py::handle h,
           const std::string& heights) {
            return over_heights(std::make_index_sequence<2>{},
                                {{v, "v", 3}, {m, "m", 3}, {h, "h", 0}}, parse_heights(heights),
                                [&](auto below, auto& a, auto& b) {
                                    return G1_at_height(d.of(below), a, b, below);
                                });
        },
        "d"_a, "v"_a, "m"_a, "h"_a, "heights"_a = "gaussian",
        R"(Smith's masking of microfacets m at the height h: float[..., 3], float[..., 3], float[...] -> float[...].

heights: "uniform" in [-1, 1] or "gaussian" of standard deviation 1; the mean over heights is G1. Source: masking-shadowing,
eq. 126-129.)");
    module.def(
        "G2_at_height",
        [](const Distribution& d, py::handle wi, py::handle wo, py::handle m, py::handle h,
           const std::string& heights) {
            return over_heights(std::make_index_sequence<3>{},
                                {{wi, "wi", 3}, {wo, "wo", 3}, {m, "m", 3}, {h, "h", 0}},
                                parse_heights(heights), [&](auto below, auto& a, auto& b, auto& c) {
                                    return G2_at_height(d.of(below), a, b, c, below);
                                });
        },
        "d"_a, "wi"_a, "wo"_a, "m"_a, "h"_a, "heights"_a = "gaussian",
        R"(Smith's masking-shadowing of microfacets m at the height h: float[..., 3] thrice, float[...] -> float[...].

heights as for G1_at_height; the mean over heights is the height-correlated G2. Source: masking-shadowing, eq. 130, 131.)");
}

}  // namespace ltmd::python
