// SPDX-License-Identifier: Apache-2.0
#include "ltmd/lobe_mixture.h"

#include <pybind11/stl.h>

#include "bindings.h"
#include "lobes.h"

namespace ltmd::python {
namespace {

LobeKind parse_kind(const std::string& name) {
    if (name == "ggx") return LobeKind::ggx;
    if (name == "beckmann") return LobeKind::beckmann;
    throw py::value_error("the kind of a lobe must be 'ggx' or 'beckmann', not '" + name + "'");
}

template <class Member>
Array<double> member_array(const Mixture& mixture, Member member) {
    Array<double> out(static_cast<py::ssize_t>(mixture.lobes.size()));
    for (std::size_t i = 0; i < mixture.lobes.size(); ++i)
        out.mutable_data()[i] = mixture.lobes[i].*member;
    return out;
}

}  // namespace

Mixture::Mixture(std::span<const MixtureLobe> given, std::optional<double> error)
    : Distribution{AnyDistribution<float>(LobeMixture<float>(given)),
                   AnyDistribution<double>(LobeMixture<double>(given))},
      lobes(normalized_lobes(given)),
      exact_single(given),
      exact(given),
      max_relative_error(error) {}

void bind_lobe_mixture(py::module_& module) {
    using namespace py::literals;
    py::class_<Mixture, Distribution> c(module, "LobeMixture",
                                        R"(A mixture of isotropic GGX and Beckmann lobes.

kind: "ggx" or "beckmann" for each lobe; alpha: their slope scales in [1e-6, 1e6]; weight: at least 0, of any sum. The GGX lobes come
first, and the weights add up to 1. Raises ValueError unless there are 1 to 64 lobes.)");
    c.def(py::init([](const std::vector<std::string>& kind, const std::vector<double>& alpha,
                      const std::vector<double>& weight) {
              if (kind.size() != alpha.size() || kind.size() != weight.size())
                  throw py::value_error(
                      "kind, alpha and weight have " + std::to_string(kind.size()) + ", " +
                      std::to_string(alpha.size()) + " and " + std::to_string(weight.size()) +
                      " items; they must have one length");
              std::vector<MixtureLobe> lobes;
              for (std::size_t i = 0; i < kind.size(); ++i)
                  lobes.push_back({parse_kind(kind[i]), alpha[i], weight[i]});
              return Mixture(lobes);
          }),
          "kind"_a, "alpha"_a, "weight"_a)
        .def_property_readonly(
            "kind",
            [](const Mixture& m) {
                std::vector<std::string> names;
                for (const MixtureLobe& lobe : m.lobes)
                    names.push_back(lobe.kind == LobeKind::ggx ? "ggx" : "beckmann");
                return names;
            })
        .def_property_readonly(
            "alpha", [](const Mixture& m) { return member_array(m, &MixtureLobe::alpha); })
        .def_property_readonly(
            "weight", [](const Mixture& m) { return member_array(m, &MixtureLobe::weight); })
        .def_property_readonly(
            "max_relative_error", [](const Mixture& m) { return m.max_relative_error; },
            "Of a fit: that of P22 over the slopes where tan^2 P22 is at least 1e-3 of its peak; "
            "None for a mixture of one's own.")
        .def("__repr__", [](const Mixture& m) {
            return "LobeMixture of " + std::to_string(m.lobes.size()) + " lobes";
        });
    bind_bounded(c);
    module.def(
        "fit_lobes",
        [](double alpha, double gamma, int max_lobes) {
            const FittedLobes fitted = fit_lobes(alpha, gamma, max_lobes);
            return Mixture(fitted.lobes, fitted.max_relative_error);
        },
        "alpha"_a, "gamma"_a, "max_lobes"_a = 6,
        R"(GTR(alpha, gamma) as at most max_lobes lobes (1 to 6): GGX for gamma <= 2, beyond one GGX lobe and Beckmann lobes.

Lobes are interpolated in a table, so they are continuous in alpha and gamma. .max_relative_error is that of P22.)");
    module.def(
        "gtr_ggx_lobes",
        [](double alpha, double gamma, int count) {
            return Mixture(gtr_ggx_lobes(alpha, gamma, count));
        },
        "alpha"_a, "gamma"_a, "count"_a,
        R"(GTR(alpha, gamma) for 0 <= gamma <= 2 as GGX lobes, by Gauss quadrature with at most `count` (1 to 40) nodes.)");
    module.def(
        "gtr_beckmann_lobes",
        [](double alpha, double gamma, int count) {
            return Mixture(gtr_beckmann_lobes(alpha, gamma, count));
        },
        "alpha"_a, "gamma"_a, "count"_a,
        R"(GTR(alpha, gamma) for 1e-3 <= gamma <= 4 as Beckmann lobes, by Gauss quadrature with at most `count` (1 to 64) nodes.)");
}

}  // namespace ltmd::python
