// SPDX-License-Identifier: Apache-2.0
#include "ltmd/passes.h"

#include <algorithm>
#include <cmath>

#include "ltmd/errors.h"
#include "parallel.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 13;

const std::array<std::string, 5> names = {"tension", "stretch", "wrinkle", "alpha2", "roughness"};

void require_known(const std::string& pass) {
    if (std::find(names.begin(), names.end(), pass) != names.end()) return;
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw InvalidInput("unknown pass '" + pass + "'; there are: " + known);
}

template <class Item>
std::span<Item> grouped(std::vector<float>& values) {
    return {reinterpret_cast<Item*>(values.data()), values.size() * sizeof(float) / sizeof(Item)};
}

}  // namespace

std::span<const std::string> pass_names() { return names; }

int pass_channels(const std::string& pass) {
    require_known(pass);
    return pass == "roughness" ? 4 : 3;
}

bool pass_uses_lobe(const std::string& pass) { return pass == "alpha2" || pass == "roughness"; }

void compute_pass(const std::string& pass, std::span<const Tension> t, const Lobe& lobe,
                  std::vector<float>& out) {
    out.resize(t.size() * static_cast<std::size_t>(pass_channels(pass)));
    if (pass == "tension")
        std::copy(t.begin(), t.end(), grouped<Vec3f>(out).begin());
    else if (pass == "stretch")
        stretch(t, grouped<Vec3f>(out));
    else if (pass == "wrinkle")
        wrinkle(t, grouped<Vec3f>(out));
    else if (pass == "alpha2")
        alpha2(t, lobe, grouped<Vec3f>(out));
    else
        roughness(t, lobe, grouped<std::array<float, 4>>(out));
}

void wrinkle(std::span<const Tension> t, std::span<Vec3f> out) {
    if (out.size() != t.size())
        throw InvalidInput("out has " + std::to_string(out.size()) + " entries; t has " +
                           std::to_string(t.size()));
    parallel_for(t.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double a = t[i][0], b = t[i][1], d = t[i][2];
            out[i] = {static_cast<float>(a), static_cast<float>(std::hypot(b, d)),
                      static_cast<float>(std::atan2(b, d))};
        }
    });
}

}  // namespace ltmd::inline v0
