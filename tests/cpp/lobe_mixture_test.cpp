// SPDX-License-Identifier: Apache-2.0
#include "ltmd/lobe_mixture.h"

#include <gtest/gtest.h>

#include "ltmd/gtr.h"
#include "ltmd/transformed_distribution.h"

namespace {

using ltmd::Direction;
using ltmd::LobeMixture;
using ltmd::Matrix2;

TEST(LobeMixture, IsADistribution) {
    static_assert(ltmd::MicrofacetDistribution<LobeMixture<float>>);
    static_assert(ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<LobeMixture<double>>>);
}

// The frame of M's lobes has the slope scales of (M M^T)^-1.
TEST(LobeMixture, FrameOfAMapIsItsLobes) {
    for (const Matrix2& m :
         {Matrix2{}, Matrix2{2, 0, 0, 0.5}, Matrix2{1, 0.7, -0.4, 2}, Matrix2{-1, 0.3, 0, 1.2}}) {
        const auto frame = ltmd::lobe_frame<double>(m);
        const auto moved = transformed(ltmd::GGX<double>(0.3), m);
        const ltmd::GGX<double> lobe(0.3 * frame.x, 0.3 * frame.y);
        for (const Direction<double>& d :
             {Direction<double>{0, 0, 1}, {0.6, 0, 0.8}, {-0.48, 0.64, 0.6}}) {
            EXPECT_NEAR(lobe.D(frame.into(d)), moved.D(d), 1e-12 * moved.D(d));
            const auto back = frame.out_of(frame.into(d));
            EXPECT_NEAR(back.x, d.x, 1e-15);
            EXPECT_NEAR(back.y, d.y, 1e-15);
        }
    }
}

// Above the horizon the density of reflected directions is D / (2 K) for any split into lobes.
TEST(LobeMixture, BoundedNormalsOfGtrAreThoseOfItsLobes) {
    const ltmd::GTR<double> gtr(0.1, 1.4);
    const LobeMixture<double> lobes(ltmd::gtr_ggx_lobes(0.1, 1.4, 24));
    const auto frame = ltmd::lobe_frame<double>({1, 0.5, 0, 2});
    const Direction<double> v = normalized(Direction<double>{0.6, -0.3, 0.4});
    for (const double u : {0.0, 0.1, 0.5, 0.9, 1.0}) {
        const auto m = gtr.sample_bounded(v, {u, 0.7}, frame);
        EXPECT_NEAR(length(m), 1, 1e-14);
        EXPECT_NEAR(gtr.pdf_bounded(v, m, frame), lobes.pdf_bounded(v, m, frame),
                    1e-10 * lobes.pdf_bounded(v, m, frame));
    }
}

TEST(LobeMixture, RandomNumbersAtTheirEndsGiveNormals) {
    for (const double gamma : {0.5, 2.0, 2.5, 4.0}) {
        const ltmd::GTR<float> gtr(0.02, gamma);
        const LobeMixture<float> lobes(ltmd::fit_lobes(0.02, gamma).lobes);
        for (const float x : {0.0F, 0.5F, 1.0F})
            for (const float y : {0.0F, 0.5F, 1.0F})
                for (const float z : {1e-4F, 0.5F, 1.0F}) {
                    const Direction<float> v{std::sqrt(1 - z * z), 0, z};
                    for (const auto& m :
                         {gtr.sample({x, y}), gtr.sample_visible(v, {x, y}), lobes.sample({x, y}),
                          lobes.sample_visible(v, {x, y}), gtr.sample_mixed(v, {x, y})}) {
                        EXPECT_NEAR(length(m), 1, 1e-6) << gamma << " " << x << " " << y;
                        EXPECT_GE(m.z, 0);
                    }
                }
    }
}

}  // namespace
