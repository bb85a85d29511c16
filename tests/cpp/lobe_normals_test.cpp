// SPDX-License-Identifier: Apache-2.0
#include "ltmd/lobe_normals.h"

#include <gtest/gtest.h>

namespace {

using Shares = ltmd::LobeShares<double, 12>;

TEST(LobeShares, PicksEachLobeOverItsShare) {
    const std::array<double, 12> share{1, 0, 2, 0.5, 0, 0, 0, 0, 0.25, 4, 0, 0};
    const Shares shares(12, [&](std::size_t i) { return share[i]; });
    EXPECT_EQ(shares.total(), 7.75);
    double before = 0;
    for (std::size_t i = 0; i < share.size(); before += share[i++]) {
        if (share[i] == 0) continue;
        for (const double place : {0.001, 0.5, 0.999}) {
            const auto picked = shares.pick((before + place * share[i]) / shares.total());
            EXPECT_EQ(picked.lobe, i);
            EXPECT_NEAR(picked.place, place, 1e-14 / share[i]);
        }
    }
}

TEST(LobeShares, PicksALobeWithAShareAtTheEnds) {
    const std::array<double, 12> share{0.7, 0, 0.1, 0.3, 0, 0, 0, 0, 0, 0, 0, 0};
    for (const std::size_t count : {std::size_t{4}, std::size_t{8}, std::size_t{12}}) {
        const Shares shares(count, [&](std::size_t i) { return share[i]; });
        EXPECT_EQ(shares.pick(0).lobe, 0);
        EXPECT_EQ(shares.pick(0).place, 0);
        const auto last = shares.pick(1);
        EXPECT_EQ(last.lobe, 3);
        EXPECT_NEAR(last.place, 1, 1e-14);
        EXPECT_LE(last.place, 1);
    }
}

}  // namespace
