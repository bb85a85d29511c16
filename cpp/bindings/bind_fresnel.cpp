// SPDX-License-Identifier: Apache-2.0
#include "ltmd/fresnel.h"

#include "bindings.h"
#include "distributions.h"
#include "ltmd/require_range.h"

namespace ltmd::python {
namespace {

/// A number with the range it must be in.
struct Bounded : Argument {
    double low, high;
};

/// function(cosine, parameters...) over arrays that are broadcast.
template <std::size_t... I, class Function>
py::object elementwise(std::index_sequence<I...>, const std::vector<Bounded>& bounded,
                       const Function& function) {
    const auto arrays = broadcast(std::vector<Argument>(bounded.begin(), bounded.end()));
    return by_dtype(arrays[0], [&](auto real) -> py::object {
        using Real = decltype(real);
        const std::array<Array<Real>, sizeof...(I)> in{Array<Real>::ensure(arrays[I])...};
        for (std::size_t i = 0; i < in.size(); ++i)
            for (py::ssize_t j = 0; j < in[i].size(); ++j)
                require_range(bounded[i].name, static_cast<double>(in[i].data()[j]), bounded[i].low,
                              bounded[i].high);
        Array<Real> out(std::vector<py::ssize_t>(in[0].shape(), in[0].shape() + in[0].ndim()));
        const std::array<const Real*, sizeof...(I)> from{in[I].data()...};
        Real* const to = out.mutable_data();
        const auto count = static_cast<std::size_t>(out.size());
        py::gil_scoped_release release;
        for (std::size_t j = 0; j < count; ++j) to[j] = function(from[I][j]...);
        return out;
    });
}

// Sums of rounded products may leave [-1, 1] a little.
Bounded cosine_argument(py::handle cosine) { return {{cosine, "cosine", 0}, -1.001, 1.001}; }
Bounded index_argument(py::handle eta) { return {{eta, "eta", 0}, 1e-3, 1e3}; }

}  // namespace

void bind_fresnel(py::module_& module) {
    using namespace py::literals;
    module.def(
        "fresnel_dielectric",
        [](py::handle cosine, py::handle eta) {
            return elementwise(std::make_index_sequence<2>{},
                               {cosine_argument(cosine), index_argument(eta)},
                               [](auto c, auto e) { return fresnel_dielectric(c, e); });
        },
        "cosine"_a, "eta"_a,
        R"(The reflectance of an interface between two dielectrics for unpolarised light: float[...], float[...] -> float[...].

cosine: of the angle between the light and the normal, in [-1, 1]; negative for light from below. eta: the refractive index below
over that above, in [1e-3, 1e3]. 1 at total internal reflection.)");
    module.def(
        "fresnel_conductor",
        [](py::handle cosine, py::handle eta, py::handle k) {
            return elementwise(
                std::make_index_sequence<3>{},
                {cosine_argument(cosine), index_argument(eta), {{k, "k", 0}, 0, 1e3}},
                [](auto c, auto e, auto x) { return fresnel_conductor(c, e, x); });
        },
        "cosine"_a, "eta"_a, "k"_a,
        R"(The reflectance of a conductor of refractive index eta + i k for unpolarised light: float[...] thrice -> float[...].

cosine: in [-1, 1], its sign ignored. eta in [1e-3, 1e3], k in [0, 1e3].)");
    module.def(
        "fresnel_schlick",
        [](py::handle cosine, py::handle f0) {
            return elementwise(std::make_index_sequence<2>{},
                               {cosine_argument(cosine), {{f0, "f0", 0}, 0, 1}},
                               [](auto c, auto f) { return fresnel_schlick(c, f); });
        },
        "cosine"_a, "f0"_a,
        R"(Schlick's approximation of the reflectance, f0 + (1 - f0) (1 - |cosine|)^5: float[...], float[...] -> float[...].

f0: the reflectance at normal incidence, in [0, 1].)");
    module.def(
        "fresnel_f82",
        [](py::handle cosine, py::handle f0, py::handle tint) {
            return elementwise(
                std::make_index_sequence<3>{},
                {cosine_argument(cosine), {{f0, "f0", 0}, 0, 1}, {{tint, "tint", 0}, 0, 1}},
                [](auto c, auto f, auto t) { return fresnel_f82(c, f, t); });
        },
        "cosine"_a, "f0"_a, "tint"_a,
        R"(Schlick's approximation with an edge tint: float[...] thrice -> float[...].

f0, tint: in [0, 1]; at the cosine 1/7, about 82 degrees, the reflectance is `tint` times Schlick's. Clamped to 0.)");
}

}  // namespace ltmd::python
