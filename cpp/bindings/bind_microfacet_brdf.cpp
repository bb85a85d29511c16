// SPDX-License-Identifier: Apache-2.0
#include "ltmd/microfacet_brdf.h"

#include "bindings.h"
#include "ltmd/require_range.h"
#include "masking_models.h"

namespace ltmd::python {

void bind_microfacet_brdf(py::module_& module) {
    using namespace py::literals;
    module.def(
        "brdf",
        [](const Distribution& d, py::handle wi, py::handle wo, py::object fresnel,
           const std::string& model) -> py::object {
            const MaskingModel parsed = parse_masking_model(model);
            const std::vector<Argument> directions{{wi, "wi", 3}, {wo, "wo", 3}};
            py::object value = over_directions(directions, [&](auto& from, auto out, auto real) {
                brdf(d.of(real), from[0], from[1], parsed, out);
            });
            if (fresnel.is_none()) return value;
            if (!PyCallable_Check(fresnel.ptr())) return value * fresnel;
            return value *
                   fresnel(over_directions(directions, [&](auto& from, auto out, auto real) {
                       using Real = decltype(real);
                       for (std::size_t i = 0; i < out.size(); ++i) {
                           const auto &a = from[0][i], &b = from[1][i];
                           const bool one_side = (a.z > 0) == (b.z > 0);
                           out[i] = one_side ? std::clamp(dot(a, reflection_normal(a, b)), Real{-1},
                                                          Real{1})
                                             : Real{1};
                       }
                   }));
        },
        "d"_a, "wi"_a, "wo"_a, "fresnel"_a = py::none(), "model"_a = "height_correlated",
        R"(Light reflected from wi to wo by mirror-like microfacets, per steradian: float[..., 3], float[..., 3] -> float[...].

F D G2 / (4 |wi_z| |wo_z|); 0 for directions on two sides of the surface or at the horizon. fresnel: the reflectance as numbers,
or a function of the cosine of the angle between wi and the microfacet (float[...] -> float[...], negative from below), such as
lambda c: ltmd.fresnel_schlick(c, 0.04); 1 if left out. model: one of MASKING_MODELS. Source: masking-shadowing, eq. 29.)");
    module.def(
        "btdf",
        [](const Distribution& d, py::handle wi, py::handle wo, double eta,
           const std::string& model) {
            const MaskingModel parsed = parse_masking_model(model);
            require_range("eta", eta, 1e-3, 1e3);
            return over_directions({{wi, "wi", 3}, {wo, "wo", 3}}, [&](auto& from, auto out,
                                                                       auto real) {
                btdf(d.of(real), from[0], from[1], static_cast<decltype(real)>(eta), parsed, out);
            });
        },
        "d"_a, "wi"_a, "wo"_a, "eta"_a, "model"_a = "height_correlated",
        R"(Light refracted from wi to wo by dielectric microfacets, as radiance, per steradian: float[..., 3], float[..., 3] -> float[...].

eta: the refractive index below over that above, in [1e-3, 1e3]; 0 for 1, where light goes straight on. 0 for directions on one
side or at the horizon and where no microfacet refracts one to the other. Swapping the directions gives the value times
(eta_i / eta_o)^2. model: one of MASKING_MODELS. Source: Walter et al. 2007, with ellipsoid-ndf, eq. 7.)");
}

}  // namespace ltmd::python
