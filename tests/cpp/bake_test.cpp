// SPDX-License-Identifier: Apache-2.0
#include "ltmd/bake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/threads.h"

namespace {

using namespace ltmd;

/// Two triangles over the left part of the tile, with a shared diagonal and corners of their own.
struct Quad {
    std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
    std::vector<std::int32_t> corner_vert = {0, 1, 2, 0, 2, 3};
    std::vector<Vec2f> corner_uv = {{0.1f, 0.1f}, {0.6f, 0.15f}, {0.55f, 0.8f},
                                    {0.1f, 0.1f}, {0.55f, 0.8f}, {0.12f, 0.7f}};
    MeshView view() const { return {triangles, corner_vert, corner_uv, 4}; }
};

/// An affine function of UV: interpolation must reproduce it wherever a centre is covered.
double affine(double u, double v, int channel) {
    return 0.7 + channel + (2.5 - channel) * u - (0.3 + 0.2 * channel) * v;
}

std::vector<float> affine_corners(const Quad& quad, int channels) {
    std::vector<float> values;
    for (const Vec2f& uv : quad.corner_uv)
        for (int k = 0; k < channels; ++k)
            values.push_back(static_cast<float>(affine(uv[0], uv[1], k)));
    return values;
}

TEST(Bake, ReproducesAnAffineFunctionAtTexelCentres) {
    const Quad quad;
    constexpr int width = 97, height = 64;
    const TexelCoverage coverage(quad.view(), width, height, {}, 0);
    for (int channels = 1; channels <= 16; ++channels)
        for (const int out_channels : {channels, channels + 1}) {
            const std::vector<float> background(static_cast<std::size_t>(channels), -5.0f);
            std::vector<float> out(static_cast<std::size_t>(width * height * out_channels), 99.0f);
            bake(coverage, affine_corners(quad, channels), channels, background, out_channels, out);
            std::size_t covered = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const auto i = static_cast<std::size_t>(y * width + x);
                    const float* texel = out.data() + i * static_cast<std::size_t>(out_channels);
                    const bool background_texel = coverage.texels()[i].triangle < 0;
                    const double u = (x + 0.5) / width, v = 1 - (y + 0.5) / height;
                    // Texels that a triangle only meets lie off the centre.
                    const CoverageTexel& c = coverage.texels()[i];
                    const bool at_border =
                        c.b0 == 0 || c.b1 == 0 || std::abs(1 - c.b0 - c.b1) < 1e-6f;
                    covered += !background_texel && !at_border;
                    for (int k = 0; k < channels; ++k) {
                        if (background_texel) {
                            ASSERT_EQ(texel[k], -5.0f);
                        } else if (!at_border) {
                            ASSERT_NEAR(texel[k], affine(u, v, k), 1e-6 * (1 + channels))
                                << x << " " << y << " " << k;
                        }
                    }
                    if (out_channels > channels) {
                        ASSERT_EQ(texel[channels], 1.0f);
                    }
                }
            EXPECT_GT(covered, 1500u);
        }
}

TEST(Bake, KeepsAConstantExactly) {
    const Quad quad;
    const TexelCoverage coverage(quad.view(), 64, 64, {}, 64);
    const std::array<float, 3> value = {1.0f / 3, 0.1f, 7e5f};
    std::vector<float> corners;
    for (std::size_t c = 0; c < 6; ++c) corners.insert(corners.end(), value.begin(), value.end());
    std::vector<float> out(64 * 64 * 4);
    bake(coverage, corners, 3, value, 4, out);
    for (std::size_t i = 0; i < out.size(); ++i)
        ASSERT_EQ(out[i], i % 4 == 3 ? 1.0f : value[i % 4]);
}

TEST(Bake, MarginTexelsTakeTheNearestPointsValue) {
    Quad quad;
    quad.corner_uv = {{0, 0}, {0.5f, 0}, {0.5f, 1}, {0, 0}, {0.5f, 1}, {0, 1}};
    const TexelCoverage coverage(quad.view(), 8, 8, {}, 2);
    std::vector<float> corners;
    for (const Vec2f& uv : quad.corner_uv) corners.push_back(uv[0] + 10 * uv[1]);
    std::vector<float> out(64);
    bake(coverage, corners, 1, std::vector<float>{-1.0f}, 1, out);
    for (std::size_t y = 0; y < 8; ++y) {
        const float v = 1 - (static_cast<float>(y) + 0.5f) / 8;
        EXPECT_NEAR(out[y * 8 + 3], 3.5f / 8 + 10 * v, 1e-5);
        EXPECT_NEAR(out[y * 8 + 4], 0.5f + 10 * v, 1e-5);
        EXPECT_NEAR(out[y * 8 + 5], 0.5f + 10 * v, 1e-5);
        EXPECT_EQ(out[y * 8 + 6], -1.0f);
    }
}

TEST(Bake, FlatValuesAreNotInterpolated) {
    const Quad quad;
    const TexelCoverage coverage(quad.view(), 32, 32, {}, 4);
    std::vector<float> out(32 * 32 * 4);
    bake_flat(coverage, std::vector<float>{1, 2, 3, 4, 5, 6}, 3, std::vector<float>{7, 8, 9}, 4,
              out);
    std::array<int, 3> seen{};
    for (std::size_t i = 0; i < 32 * 32; ++i) {
        const std::int32_t triangle = coverage.texels()[i].triangle;
        const float first = triangle < 0 ? 7 : static_cast<float>(1 + 3 * triangle);
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_EQ(out[i * 4 + k], first + static_cast<float>(k));
        ASSERT_EQ(out[i * 4 + 3], 1.0f);
        ++seen[static_cast<std::size_t>(triangle + 1)];
    }
    for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(Bake, HasTheSameBitsForAnyThreadCount) {
    const Quad quad;
    const TexelCoverage coverage(quad.view(), 512, 300, {}, 8);
    const std::vector<float> corners = affine_corners(quad, 3), background = {1, 0, 1};
    std::vector<float> one(512 * 300 * 4), many(one.size());
    set_thread_count(1);
    bake(coverage, corners, 3, background, 4, one);
    set_thread_count(5);
    bake(coverage, corners, 3, background, 4, many);
    set_thread_count(0);
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(float)), 0);
}

TEST(Bake, RefusesWrongSizes) {
    const Quad quad;
    const TexelCoverage coverage(quad.view(), 4, 4);
    const std::vector<float> corners(18), background(3);
    std::vector<float> out(64);
    EXPECT_NO_THROW(bake(coverage, corners, 3, background, 4, out));
    EXPECT_THROW(bake(coverage, std::span(corners).first(17), 3, background, 4, out), InvalidInput);
    EXPECT_THROW(bake(coverage, corners, 3, std::span(background).first(2), 4, out), InvalidInput);
    EXPECT_THROW(bake(coverage, corners, 3, background, 3, out), InvalidInput);
    EXPECT_THROW(bake(coverage, corners, 3, background, 5, out), InvalidInput);
    EXPECT_THROW(bake(coverage, corners, 0, background, 1, out), InvalidInput);
    EXPECT_THROW(bake(coverage, corners, 17, background, 17, out), InvalidInput);
    EXPECT_THROW(bake_flat(coverage, corners, 3, background, 4, out), InvalidInput);
    EXPECT_THROW(bake(coverage, corners, 3, background, 4, std::span(out).first(63)), InvalidInput);
}

}  // namespace
