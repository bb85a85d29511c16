// SPDX-License-Identifier: Apache-2.0
#include "ltmd/v_cavity.h"

#include "bindings.h"
#include "masking_models.h"

namespace ltmd::python {

void bind_v_cavity(py::module_& module) {
    using namespace py::literals;
    module.def(
        "v_cavity_pdf_visible",
        [](const Distribution& d, py::handle v, py::handle m) {
            return over_directions(
                {{v, "v", 3}, {m, "m", 3}}, [&](auto& from, auto out, auto real) {
                    for (std::size_t i = 0; i < out.size(); ++i)
                        out[i] = v_cavity_pdf_visible(d.of(real), from[0][i], from[1][i]);
                });
        },
        "d"_a, "v"_a, "m"_a,
        R"(The density of normals that v sees of V-cavities, per steradian: float[..., 3], float[..., 3] -> float[...].

G1(v, m) max(0, v.m) D(m) / v_z; 0 for v_z <= 0. Source: masking-shadowing, eq. 50.)");
    module.def(
        "v_cavity_sample_visible",
        [](const Distribution& d, py::handle v, py::handle u) {
            const auto [views, numbers] = broadcast(v, "v", 3, u, "u", 3);
            return by_dtype(views, [&, &a = views, &b = numbers](auto real) -> py::object {
                using Real = decltype(real);
                const auto given = require<Real>(a, "v", {3}, true);
                const auto uniform = require<Real>(b, "u", {3}, true);
                const auto second = items<ltmd::Direction<Real>>(uniform);
                return for_each_item<ltmd::Direction<Real>, ltmd::Direction<Real>>(
                    given, [&](auto from, auto to) {
                        for (std::size_t i = 0; i < to.size(); ++i)
                            to[i] = v_cavity_sample_visible(
                                d.of(real), from[i], {second[i].x, second[i].y}, second[i].z);
                    });
            });
        },
        "d"_a, "v"_a, "u"_a,
        R"(Normals that v sees of V-cavities, from three random numbers in [0, 1]: float[..., 3], float[..., 3] -> float[..., 3].

Source: masking-shadowing, section 4.2.)");
}

}  // namespace ltmd::python
