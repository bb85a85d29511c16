// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

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

/// call(v, other) for each pair of a view and another item of `Other`, given as arrays.
template <template <class> class Other, class Call>
py::object for_each_view(py::handle v, py::handle other, const char* name, const Call& call) {
    constexpr auto size = static_cast<py::ssize_t>(sizeof(Other<float>) / sizeof(float));
    const auto [views, others] = broadcast(v, "v", 3, other, name, size);
    return by_dtype(views, [&, &a = views, &b = others](auto real) -> py::object {
        using Real = decltype(real);
        const auto given = require<Real>(a, "v", {3}, true);
        const auto second = require<Real>(b, name, {size}, true);
        const auto second_items = items<Other<Real>>(second);
        using Out = decltype(call(Direction<Real>{}, Other<Real>{}));
        return for_each_item<Direction<Real>, Out>(given, [&](auto from, auto to) {
            for (std::size_t i = 0; i < from.size(); ++i) to[i] = call(from[i], second_items[i]);
        });
    });
}

/// sample_bounded() and pdf_bounded() of a class that has exact_of().
template <class Class, class... Options>
void bind_bounded(py::class_<Class, Options...>& c) {
    using namespace py::literals;
    const auto frame = [](py::handle m) {
        return m.is_none() ? Matrix2{} : parse_surface_matrix(m);
    };
    c.def(
         "sample_bounded",
         [frame](const Class& self, py::handle v, py::handle u, py::handle m) {
             const Matrix2 matrix = frame(m);
             const auto frames = std::pair(lobe_frame<float>(matrix), lobe_frame<double>(matrix));
             return for_each_view<Uniform>(v, u, "u", [&](const auto& a, const auto& b) {
                 using Real = std::decay_t<decltype(a.x)>;
                 return self.exact_of(a.x).sample_bounded(a, b, std::get<LobeFrame<Real>>(frames));
             });
         },
         "v"_a, "u"_a, "M"_a = py::none(),
         R"(Visible normals for reflection of v, from random numbers in [0, 1]: float[..., 3], float[..., 2] -> float[..., 3].

Of GGX lobes, fewer reflect v below the horizon: the variance of a reflection is 3 to 6 times less than with sample_visible(). M: the
linear map of the surface, as in transformed(). Raises ValueError if not all lobes are GGX.)")
        .def(
            "pdf_bounded",
            [frame](const Class& self, py::handle v, py::handle normals, py::handle m) {
                const Matrix2 matrix = frame(m);
                const auto frames =
                    std::pair(lobe_frame<float>(matrix), lobe_frame<double>(matrix));
                return for_each_view<Direction>(v, normals, "m", [&](const auto& a, const auto& b) {
                    using Real = std::decay_t<decltype(a.x)>;
                    return self.exact_of(a.x).pdf_bounded(a, b, std::get<LobeFrame<Real>>(frames));
                });
            },
            "v"_a, "m"_a, "M"_a = py::none(),
            R"(The density of sample_bounded(), per steradian of m; divided by 4 v.m, of the reflected direction: float[..., 3], float[..., 3] -> float[...].)");
}

}  // namespace ltmd::python
