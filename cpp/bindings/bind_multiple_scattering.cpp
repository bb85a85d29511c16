// SPDX-License-Identifier: Apache-2.0
#include "ltmd/multiple_scattering.h"

#include "bindings.h"
#include "masking_models.h"

namespace ltmd::python {
namespace {

template <class Real>
using Scattering = ltmd::MultipleScattering<AnyDistribution<Real>>;

py::object albedo(const Distribution& d, py::handle wo, const char* name, MaskingModel model,
                  int points) {
    return over_directions({{wo, name, 3}}, [&](auto& from, auto out, auto real) {
        single_scattering_albedo(d.of(real), from[0], model, points, out);
    });
}

/// A MultipleScattering in Python.
struct BoundScattering {
    BoundScattering(const Distribution& d, MaskingModel m, int n)
        : distribution(d),
          model(m),
          points(n),
          mean_energy(Scattering<double>(d.full, m, n).mean_energy()) {}

    py::object energy(py::handle w, const char* name) const {
        const auto numpy = py::module_::import("numpy");
        const py::object reflected = albedo(distribution, w, name, model, points);
        const py::object rest = py::int_(1) - reflected;
        // Below the surface there is no light to lose.
        const py::object z = floating(w, name)[py::make_tuple(py::ellipsis(), 2)];
        return numpy.attr("where")(numpy.attr("greater")(z, 0), numpy.attr("maximum")(rest, 0),
                                   numpy.attr("zeros_like")(rest));
    }

    Distribution distribution;
    MaskingModel model;
    int points;
    double mean_energy;
};

}  // namespace

void bind_multiple_scattering(py::module_& module) {
    using namespace py::literals;
    module.def(
        "single_scattering_albedo",
        [](const Distribution& d, py::handle wo, const std::string& model, int points) {
            require_points(points);
            return albedo(d, wo, "wo", parse_masking_model(model), points);
        },
        "d"_a, "wo"_a, "model"_a = "height_correlated", "points"_a = 32,
        R"(The part of the light from wo that leaves mirrors (F = 1) after one reflection, in [0, 1]: float[..., 3] -> float[...].

By points^2 normals that wo sees; points in [1, 1024]. 0 for wo_z <= 0. Source: masking-shadowing, eq. 104.)");
    module.def(
        "average_visible_fresnel",
        [](const Distribution& d, py::handle wo, const py::function& fresnel,
           int points) -> py::object {
            require_points(points);
            const py::array views = floating(wo, "wo");
            return by_dtype(views, [&](auto real) -> py::object {
                using Real = decltype(real);
                const Array<Real> given = require<Real>(views, "wo", {3}, true);
                std::vector<py::ssize_t> shape(given.shape(), given.shape() + given.ndim() - 1);
                shape.push_back(py::ssize_t{points} * points);
                Array<Real> cosines(shape);
                Real* to = cosines.mutable_data();
                for (const auto& v : items<ltmd::Direction<Real>>(given))
                    visible_normals_mean(d.of(real), v, points, [&](const auto& m) {
                        return *to++ = std::clamp(dot(v, m), Real{0}, Real{1});
                    });
                return py::module_::import("numpy").attr("mean")(fresnel(cosines), "axis"_a = -1);
            });
        },
        "d"_a, "wo"_a, "fresnel"_a, "points"_a = 32,
        R"(The mean of fresnel(cosine) over the microfacets that wo sees: float[..., 3] -> float[...].

fresnel: a function of an array of the cosines wo.m. points^2 normals, points in [1, 1024]. Source: masking-shadowing, eq. 105.)");
    py::class_<BoundScattering>(
        module, "MultipleScattering",
        R"(The light that leaves mirror-like microfacets (F = 1) after two reflections or more.

d: a distribution; model: one of MASKING_MODELS; points^2 normals are summed for each direction, points in [1, 1024].
Source: masking-shadowing, eq. 102-104.)")
        .def(py::init([](const Distribution& d, const std::string& model, int points) {
                 require_points(points);
                 return BoundScattering(d, parse_masking_model(model), points);
             }),
             "d"_a, "model"_a = "height_correlated", "points"_a = 32)
        .def_readonly("mean_energy", &BoundScattering::mean_energy,
                      "energy() averaged over diffuse light.")
        .def(
            "energy", [](const BoundScattering& s, py::handle w) { return s.energy(w, "w"); },
            "w"_a,
            R"(The part of the light from w that is reflected more than once, in [0, 1]; 0 for w_z <= 0: float[..., 3] -> float[...].

Source: masking-shadowing, eq. 104.)")
        .def(
            "brdf",
            [](const BoundScattering& s, py::handle wi, py::handle wo) -> py::object {
                const auto [i, o] = broadcast(wi, "wi", 3, wo, "wo", 3);
                if (!(s.mean_energy > 0)) return s.energy(i, "wi") * py::int_(0);
                return s.energy(i, "wi") * s.energy(o, "wo") *
                       py::float_(std::numbers::inv_pi / s.mean_energy);
            },
            "wi"_a, "wo"_a,
            R"(energy(wi) energy(wo) / (pi mean_energy), per steradian: float[..., 3], float[..., 3] -> float[...].

With one reflection, ltmd.brdf, it passes the white furnace. Source: masking-shadowing, eq. 102, 103.)");
}

}  // namespace ltmd::python
