// SPDX-License-Identifier: Apache-2.0
#include "ltmd/diffuse_microfacets.h"

#include "bindings.h"
#include "masking_models.h"

namespace ltmd::python {

namespace {

/// A method of two directions from function(distribution, wi, wo, model, points, out) over arrays.
template <class Function>
auto by_points(Function function) {
    return [function](const Distribution& d, py::handle wi, py::handle wo, const std::string& model,
                      int points) {
        const MaskingModel parsed = parse_masking_model(model);
        require_points(points);
        return over_directions({{wi, "wi", 3}, {wo, "wo", 3}},
                               [&](auto& from, auto out, auto real) {
                                   function(d.of(real), from[0], from[1], parsed, points, out);
                               });
    };
}

}  // namespace

void bind_diffuse_microfacets(py::module_& module) {
    using namespace py::literals;
    module.def(
        "diffuse_brdf", by_points([](auto&&... arguments) { diffuse_brdf(arguments...); }), "d"_a,
        "wi"_a, "wo"_a, "model"_a = "height_correlated", "points"_a = 32,
        R"(Light reflected once from wi to wo by Lambertian microfacets of albedo 1, per steradian: float[..., 3], float[..., 3] -> float[...].

By points^2 normals that either direction sees; points in [1, 1024]. 0 unless wi_z > 0 and wo_z > 0. model: one of MASKING_MODELS.
Source: masking-shadowing, eq. 31.)");
    module.def(
        "diffuse_weak_furnace",
        by_points([](auto&&... arguments) { diffuse_weak_furnace(arguments...); }), "d"_a, "wi"_a,
        "wo"_a, "model"_a = "height_correlated", "points"_a = 32,
        R"(|wi_z| diffuse_brdf with the masking of wo alone, wi above or below the surface: float[..., 3], float[..., 3] -> float[...].

Integrates to 1 over all wi if the model conserves the visible area. Source: masking-shadowing, eq. 37.)");
}

}  // namespace ltmd::python
