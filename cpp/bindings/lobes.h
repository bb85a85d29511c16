// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <tuple>

#include "distributions.h"
#include "ltmd/lobe_mixture.h"

namespace ltmd::python {

/// A mixture, in Python.
struct Mixture : Distribution {
    std::vector<MixtureLobe> lobes;
    LobeMixture<float> exact_single;
    LobeMixture<double> exact;
    std::optional<double> max_relative_error;

    explicit Mixture(std::span<const MixtureLobe> given,
                     std::optional<double> error = std::nullopt);
    const LobeMixture<float>& exact_of(float) const { return exact_single; }
    const LobeMixture<double>& exact_of(double) const { return exact; }
};

/// sample_bounded() and pdf_bounded() of a class that has exact_of().
template <class Class, class... Options>
void bind_bounded(py::class_<Class, Options...>& c) {
    using namespace py::literals;
    const auto frames = [](py::handle m) {
        const Matrix2 matrix = m.is_none() ? Matrix2{} : parse_surface_matrix(m);
        return std::tuple(lobe_frame<float>(matrix), lobe_frame<double>(matrix));
    };
    c.def(
         "sample_bounded",
         [frames](const Class& self, py::handle v, py::handle u, py::handle m, py::handle out) {
             return over_views<Uniform, true>(
                 v, u, "u", out, [&, frame = frames(m)](auto real, auto a, auto b, auto to) {
                     self.exact_of(real).sample_bounded(
                         a, b, std::get<LobeFrame<decltype(real)>>(frame), to);
                 });
         },
         "v"_a, "u"_a, "M"_a = py::none(), py::kw_only(), "out"_a = py::none(),
         R"(Visible normals for reflection of v, from random numbers in [0, 1]: float[..., 3], float[..., 2] -> float[..., 3].

Of GGX lobes, fewer reflect v below the horizon: the variance of a reflection is 3 to 6 times less than with sample_visible(). M: the
linear map of the surface, as in transformed(). Raises ValueError if not all lobes are GGX.)")
        .def(
            "pdf_bounded",
            [frames](const Class& self, py::handle v, py::handle normals, py::handle m,
                     py::handle out) {
                return over_views<Direction, false>(
                    v, normals, "m", out,
                    [&, frame = frames(m)](auto real, auto a, auto b, auto to) {
                        self.exact_of(real).pdf_bounded(
                            a, b, std::get<LobeFrame<decltype(real)>>(frame), to);
                    });
            },
            "v"_a, "m"_a, "M"_a = py::none(), py::kw_only(), "out"_a = py::none(),
            R"(The density of sample_bounded(), per steradian of m; divided by 4 v.m, of the reflected direction: float[..., 3], float[..., 3] -> float[...].)");
}

}  // namespace ltmd::python
