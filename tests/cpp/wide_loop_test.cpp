// SPDX-License-Identifier: Apache-2.0
#include "ltmd/wide_loop.h"

#include <gtest/gtest.h>

#include <cstring>
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

/// All that a distribution gives for arrays.
struct Results {
    std::vector<Direction> samples, visible;
    std::vector<float> D, G1, pdf_visible;

    bool operator==(const Results& other) const {
        const auto same = [](const auto& a, const auto& b) {
            return a.size() == b.size() &&
                   std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
        };
        return same(samples, other.samples) && same(visible, other.visible) && same(D, other.D) &&
               same(G1, other.G1) && same(pdf_visible, other.pdf_visible);
    }
};

class WideLoop : public testing::TestWithParam<ltmd::AnyDistribution<float>> {
protected:
    WideLoop() {
        std::mt19937 random(0);
        std::uniform_real_distribution<float> uniform(0, 1);
        for (int i = 0; i < 10007; ++i) {
            u.push_back({uniform(random), uniform(random)});
            v.push_back(normalized(
                Direction{uniform(random) - 0.5F, uniform(random) - 0.5F, uniform(random) - 0.1F}));
        }
    }

    /// In pieces of `piece` items.
    Results evaluate(std::size_t piece) const {
        const ltmd::AnyDistribution<float>& d = GetParam();
        const std::size_t n = u.size();
        Results r{std::vector<Direction>(n), std::vector<Direction>(n), std::vector<float>(n),
                  std::vector<float>(n), std::vector<float>(n)};
        const std::span<const Direction> views = v;
        const std::span<const Uniform> random = u;
        const auto part = [&](auto& out, std::size_t i, std::size_t m) {
            return std::span(out).subspan(i, m);
        };
        for (std::size_t i = 0; i < n; i += piece) {
            const std::size_t m = std::min(piece, n - i);
            const auto view = views.subspan(i, m);
            d.sample(random.subspan(i, m), part(r.samples, i, m));
            d.sample_visible(view, random.subspan(i, m), part(r.visible, i, m));
            const std::span<const Direction> normals = part(r.samples, i, m);
            d.D(normals, part(r.D, i, m));
            d.G1(view, part(r.G1, i, m));
            d.pdf_visible(view, normals, part(r.pdf_visible, i, m));
        }
        return r;
    }

    std::vector<Direction> v;
    std::vector<Uniform> u;
};

TEST_P(WideLoop, GivesTheSameBitsForOneItemAndManyOnAnyNumberOfThreads) {
    ltmd::set_thread_count(1);
    const Results one_by_one = evaluate(1);
    for (const int threads : {1, 3}) {
        ltmd::set_thread_count(threads);
        EXPECT_TRUE(evaluate(u.size()) == one_by_one) << threads;
        EXPECT_TRUE(evaluate(77) == one_by_one) << threads;
    }
    ltmd::set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(
    Distributions, WideLoop,
    testing::Values(
        ltmd::AnyDistribution<float>(ltmd::GGX<float>(0.3, 0.1)),
        ltmd::AnyDistribution<float>(ltmd::Beckmann<float>(0.3, 0.1)),
        ltmd::AnyDistribution<float>(ltmd::Phong<float>(20)),
        ltmd::AnyDistribution<float>(ltmd::GTR<float>(0.1, 1.4)),
        ltmd::AnyDistribution<float>(ltmd::GTR<float>(0.1, 3.3)).transformed({1, 0.4, 0, 1}),
        ltmd::AnyDistribution<float>(ltmd::GGX<float>(0.3)).transformed({1, 2, 0, 1}),
        ltmd::AnyDistribution<float>(ltmd::Beckmann<float>(2)).transformed({-1, 0.3, 0, 1.2})));

}  // namespace
