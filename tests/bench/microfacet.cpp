// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per call of the microfacet distributions in single precision, on one core: one call
// at a time ("scalar") and arrays through AnyDistribution ("array"), plain and under a matrix.
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>
#include <vector>

#include "ltmd/any_distribution.h"
#include "ltmd/beckmann.h"
#include "ltmd/ggx.h"
#include "ltmd/gtr.h"
#include "ltmd/phong.h"
#include "ltmd/threads.h"

namespace {

using Direction = ltmd::Direction<float>;
using Uniform = ltmd::Uniform<float>;

constexpr std::size_t count = 1 << 14;
constexpr int repeats = 9;

/// The least time of a call in nanoseconds.
template <class Function>
double nanoseconds(const Function& function) {
    function();
    double best = 1e18;
    for (int i = 0; i < repeats; ++i) {
        // Processor time: others may be at work on the machine.
        const std::clock_t start = std::clock();
        function();
        best = std::min(best, 1e9 / CLOCKS_PER_SEC * static_cast<double>(std::clock() - start));
    }
    return best / count;
}

float sum(float value) { return value; }
float sum(const Direction& value) { return value.x + value.y + value.z; }

volatile float sink;

/// Of function(i), added up so that no call is left out. Calls that a compiler does in vectors are
/// no measure of one call: that is forbidden where it can be.
template <class Function>
double scalar(const Function& function) {
    return nanoseconds([&] {
        float total = 0;
        for (std::size_t i = 0; i < count; ++i) {
            total += sum(function(i));
#if defined(__GNUC__)
            asm volatile("");
#endif
        }
        sink = total;
    });
}

struct Data {
    std::vector<Direction> normals, views, directions;
    std::vector<Uniform> uniform;
    std::vector<float> values;
};

struct Times {
    double D, G1, sample, visible;
    /// Bounded visible normals, if there are.
    double bounded = std::numeric_limits<double>::quiet_NaN();
};

template <class Distribution>
Times one_by_one(const Distribution& d, const Data& in) {
    Times times{
        scalar([&](std::size_t i) { return d.D(in.normals[i]); }),
        scalar([&](std::size_t i) { return d.G1(in.views[i]); }),
        scalar([&](std::size_t i) { return d.sample(in.uniform[i]); }),
        scalar([&](std::size_t i) { return d.sample_visible(in.views[i], in.uniform[i]); })};
    if constexpr (requires { d.gamma(), d.sample_bounded(in.views[0], in.uniform[0]); })
        if (d.gamma() <= 2)
            times.bounded =
                scalar([&](std::size_t i) { return d.sample_bounded(in.views[i], in.uniform[i]); });
    return times;
}

Times arrays(const ltmd::AnyDistribution<float>& d, Data& data) {
    const std::span<const Direction> m = data.normals, v = data.views;
    const std::span<const Uniform> u = data.uniform;
    return {nanoseconds([&] { d.D(m, data.values); }), nanoseconds([&] { d.G1(v, data.values); }),
            nanoseconds([&] { d.sample(u, data.directions); }),
            nanoseconds([&] { d.sample_visible(v, u, data.directions); })};
}

void print(const char* name, const char* way, const Times& plain, const Times& transformed) {
    std::printf("%-16s %-6s %6.2f %6.2f %7.2f %7.2f | %6.2f %6.2f %7.2f %7.2f | %5.2f %5.2f", name,
                way, plain.D, plain.G1, plain.sample, plain.visible, transformed.D, transformed.G1,
                transformed.sample, transformed.visible, transformed.D / plain.D,
                transformed.G1 / plain.G1);
    if (plain.bounded > 0) std::printf(" | bounded %7.2f", plain.bounded);
    std::printf("\n");
}

template <class Distribution>
void measure(const char* name, const Distribution& d, Data& data) {
    const auto under_m = transformed(d, ltmd::Matrix2{1.3, 0.4, -0.2, 0.8});
    std::mt19937 random(0);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (Direction& m : data.normals) m = d.sample({uniform(random), uniform(random)});
    print(name, "scalar", one_by_one(d, data), one_by_one(under_m, data));
    const ltmd::AnyDistribution<float> any(d);
    print(name, "array", arrays(any, data), arrays(any.transformed({1.3, 0.4, -0.2, 0.8}), data));
}

}  // namespace

int main() {
    ltmd::set_thread_count(1);
    Data data;
    data.normals.resize(count);
    data.directions.resize(count);
    data.values.resize(count);
    std::mt19937 random(0);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (std::size_t i = 0; i < count; ++i) {
        data.uniform.push_back({uniform(random), uniform(random)});
        const float z = 1 - 0.95F * uniform(random), phi = 6.2831853F * uniform(random),
                    r = std::sqrt(1 - z * z);
        data.views.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
    std::printf("%-23s %28s | %30s | %11s\n", "ns per call", "D     G1  sample visible",
                "under M: D     G1  sample visible", "ratios D G1");
    measure("GGX", ltmd::GGX<float>(0.3, 0.2), data);
    measure("Beckmann", ltmd::Beckmann<float>(0.3, 0.2), data);
    measure("GTR(0.16, 1.4)", ltmd::GTR<float>(0.16, 1.4), data);
    measure("GTR(0.01, 1.4)", ltmd::GTR<float>(0.01, 1.4), data);
    measure("GTR(0.16, 3)", ltmd::GTR<float>(0.16, 3), data);
    measure("STD(0.3, 3)", ltmd::STD<float>(0.3, 3), data);
    measure("Phong(20)", ltmd::Phong<float>(20), data);
}
