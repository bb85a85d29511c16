// SPDX-License-Identifier: Apache-2.0
#include "bindings.h"
#include "ltmd/microfacet_brdf.h"
#include "ltmd/require_range.h"
#include "masking_models.h"

namespace ltmd::python {
namespace {

constexpr std::pair<const char*, MaskingModel> models[] = {
    {"separable", MaskingModel::separable},
    {"height_correlated", MaskingModel::height_correlated},
    {"direction_correlated", MaskingModel::direction_correlated},
    {"height_direction_correlated", MaskingModel::height_direction_correlated},
    {"v_cavity", MaskingModel::v_cavity},
    {"implicit", MaskingModel::implicit},
    {"schlick_smith", MaskingModel::schlick_smith},
    {"kelemen", MaskingModel::kelemen},
};

}  // namespace

MaskingModel parse_masking_model(const std::string& name) {
    std::string known;
    for (const auto& [text, model] : models) {
        if (name == text) return model;
        known += (known.empty() ? "'" : ", '") + std::string(text) + "'";
    }
    throw py::value_error("model must be one of " + known + ", not '" + name + "'");
}

void require_points(int points) { require_range("points", points, 1, 1024); }

void bind_masking(py::module_& module) {
    using namespace py::literals;
    py::tuple names(std::size(models));
    for (std::size_t i = 0; i < std::size(models); ++i) names[i] = models[i].first;
    module.attr("MASKING_MODELS") = names;
    module.def(
        "G1",
        [](const Distribution& d, py::handle v, py::handle m, const std::string& model) {
            const MaskingModel parsed = parse_masking_model(model);
            return over_directions({{v, "v", 3}, {m, "m", 3}},
                                   [&](auto& from, auto out, auto real) {
                                       G1(d.of(real), from[0], from[1], parsed, out);
                                   });
        },
        "d"_a, "v"_a, "m"_a, "model"_a = "height_correlated",
        R"(Masking: the fraction of the microfacets of normal m that v sees: float[..., 3], float[..., 3] -> float[...].

model: one of MASKING_MODELS; the four of Smith are alike here. 0 for microfacets that face away and at v_z = 0; a v below the
surface sees its other side. In [0, 1] except "kelemen".
Source: masking-shadowing, eq. 43, 49, 56, 59, section 4.3.)");
    module.def(
        "G2",
        [](const Distribution& d, py::handle wi, py::handle wo, py::object m,
           const std::string& model) {
            const MaskingModel parsed = parse_masking_model(model);
            if (!m.is_none())
                return over_directions({{wi, "wi", 3}, {wo, "wo", 3}, {m, "m", 3}},
                                       [&](auto& from, auto out, auto real) {
                                           G2(d.of(real), from[0], from[1], from[2], parsed, out);
                                       });
            return over_directions(
                {{wi, "wi", 3}, {wo, "wo", 3}}, [&](auto& from, auto out, auto real) {
                    using Real = decltype(real);
                    std::vector<ltmd::Direction<Real>> normals(out.size());
                    for (std::size_t i = 0; i < out.size(); ++i)
                        if ((from[0][i].z > 0) == (from[1][i].z > 0))
                            normals[i] = reflection_normal(from[0][i], from[1][i]);
                    G2(d.of(real), from[0], from[1],
                       std::span<const ltmd::Direction<Real>>(normals), parsed, out);
                });
        },
        "d"_a, "wi"_a, "wo"_a, "m"_a = py::none(), "model"_a = "height_correlated",
        R"(Masking-shadowing: the fraction of the microfacets of normal m that both wi and wo see: float[..., 3] thrice -> float[...].

m: the normal that mirrors wi to wo if left out, then 0 for directions on two sides of the surface. model: one of MASKING_MODELS.
On two sides the height-correlated forms are B(1 + Lambda_i, 1 + Lambda_o), "v_cavity" is max(0, G1 + G1 - 1), the others the
product. Source: masking-shadowing, eq. 98-101, 55-60; ellipsoid-ndf, eq. 7.)");
}

}  // namespace ltmd::python
