// SPDX-License-Identifier: Apache-2.0
#include "ltmd/lobe_parameters.h"

#include "bindings.h"
#include "distributions.h"
#include "ltmd/passes.h"

namespace ltmd::python {
namespace {

/// An array of a function of each tension, [..., k] as `k` items.
template <class Item, class Function>
Array<float> of_each(py::handle t, const Function& function) {
    const auto values = require<float>(t, "t", {3}, true);
    Array<float> out =
        empty_like_leading(values, {static_cast<py::ssize_t>(sizeof(Item) / sizeof(float))});
    const auto from = items<Tension>(values);
    const auto to = mutable_items<Item>(out);
    py::gil_scoped_release release;
    function(from, to);
    return out;
}

}  // namespace

Lobe parse_lobe(py::handle alpha, py::handle m0, double strength, double height_response) {
    Lobe lobe;
    const auto both = Array<double>::ensure(alpha);
    if (!both) {
        PyErr_Clear();
        throw py::type_error("alpha must be a number or (alpha_x, alpha_y)");
    }
    if (both.ndim() > 1 || (both.ndim() == 1 && both.shape(0) != 2))
        throw py::value_error("alpha must be a number or have shape (2,), not " + shape_text(both));
    lobe.alpha_x = both.data()[0];
    lobe.alpha_y = both.data()[both.size() - 1];
    if (!m0.is_none()) {
        const auto values = Array<double>::ensure(m0);
        if (!values) {
            PyErr_Clear();
            throw py::type_error("M0 must be a 2x2 matrix of numbers");
        }
        if (values.ndim() != 2 || values.shape(0) != 2 || values.shape(1) != 2)
            throw py::value_error("M0 must have shape (2, 2), not " + shape_text(values));
        const double* m = values.data();
        lobe.m0 = {m[0], m[1], m[2], m[3]};
    }
    lobe.strength = strength;
    lobe.height_response = height_response;
    validate(lobe);
    return lobe;
}

void bind_lobe_parameters(py::module_& module) {
    using namespace py::literals;
    module.def(
        "stretch_matrix", [](double s) { return matrix_array(stretch_matrix(s)); }, "s"_a,
        R"(The stretch anisotropy float64[2, 2]: diag(1/(1-s), 1-s), or diag(1+s, 1/(1+s)) for s < 0; -1 < s < 1.

Source: microsurface-transformations, eq. 31.)");
    module.def(
        "material_matrix",
        [](double stretch, double rotation, double shear) {
            return matrix_array(material_matrix(stretch, rotation, shear));
        },
        "stretch"_a, "rotation"_a, "shear"_a,
        R"(A material's anisotropy M0 = Rot(rotation) [[1, shear], [0, 1]] stretch_matrix(stretch), float64[2, 2].

rotation: radians, counter-clockwise from U. ltmd.material_matrix(0, 0, 0) is the identity.)");
    module.def(
        "alpha2",
        [](py::handle t, py::handle alpha, py::handle m0, double strength, double height) {
            const Lobe lobe = parse_lobe(alpha, m0, strength, height);
            return of_each<Vec3f>(t, [&](auto from, auto to) { alpha2(from, lobe, to); });
        },
        "t"_a, "alpha"_a, "M0"_a = py::none(), "strength"_a = 1.0, "height_response"_a = 0.0,
        R"((sigma_xx, sigma_xy, sigma_yy) of a lobe's alpha^2 matrix under tensions t: float32[..., 3] -> float32[..., 3].

Sigma' = h^2 M^-T Sigma M^-1, M = T_strength M0, Sigma = diag(alpha_x^2, alpha_y^2), h = det(T_strength)^-height_response.
alpha: a number or (alpha_x, alpha_y), above 0. M0: 2x2, the material's own anisotropy (the identity by default).
strength: 0 no deformation, 1 all of it. height_response: 0 heights are kept (the paper), 1 volume is kept.
Raises ValueError for other shapes, an M0 that is not invertible, or a tension without a positive diagonal (the first is named).
Source: microsurface-transformations, eq. 9, 29-31, section 4.1.)");
    module.def(
        "roughness",
        [](py::handle t, py::handle alpha, py::handle m0, double strength, double height) {
            const Lobe lobe = parse_lobe(alpha, m0, strength, height);
            return of_each<std::array<float, 4>>(
                t, [&](auto from, auto to) { roughness(from, lobe, to); });
        },
        "t"_a, "alpha"_a, "M0"_a = py::none(), "strength"_a = 1.0, "height_response"_a = 0.0,
        R"((alpha_x, alpha_y, cos 2 angle, sin 2 angle) of a lobe under tensions t: float32[..., 3] -> float32[..., 4].

The pass `roughness`: lobe_parameters() without the jump of the angle at pi. Arguments and errors as alpha2.)");
    module.def(
        "lobe_parameters",
        [](py::handle t, py::handle alpha, py::handle m0, double strength, double height) {
            const Lobe lobe = parse_lobe(alpha, m0, strength, height);
            const auto values = require<float>(t, "t", {3}, true);
            std::vector<Vec3f> all(static_cast<std::size_t>(values.size() / 3));
            Array<float> parts[3] = {empty_like_leading(values, {}), empty_like_leading(values, {}),
                                     empty_like_leading(values, {})};
            const auto from = items<Tension>(values);
            float* to[3] = {parts[0].mutable_data(), parts[1].mutable_data(),
                            parts[2].mutable_data()};
            {
                py::gil_scoped_release release;
                lobe_parameters(from, lobe, all);
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t i = 0; i < all.size(); ++i) to[k][i] = all[i][k];
            }
            return py::make_tuple(parts[0], parts[1], parts[2]);
        },
        "t"_a, "alpha"_a, "M0"_a = py::none(), "strength"_a = 1.0, "height_response"_a = 0.0,
        R"((alpha_x, alpha_y, angle) of a lobe under tensions t: float32[..., 3] -> three float32[...].

alpha_x <= alpha_y; angle in [0, pi) from X (along dP/du) to the direction of alpha_x, 0 where both are equal.
Alphas are not clamped: a squeeze can bring them past 1. Arguments and errors as alpha2.)");
    module.def(
        "wrinkle",
        [](py::handle t) {
            return of_each<Vec3f>(t, [](auto from, auto to) { wrinkle(from, to); });
        },
        "t"_a,
        R"((stretch along u, stretch along v, shear angle in radians) of tensions t: float32[..., 3] -> float32[..., 3].

(t11, hypot(t12, t22), atan2(t12, t22)), for a rest state with perpendicular u and v. At rest (1, 1, 0).)");
}

}  // namespace ltmd::python
