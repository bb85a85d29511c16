// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sequence_baker.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "ltmd/bake.h"
#include "ltmd/errors.h"
#include "ltmd/exr.h"
#include "ltmd/threads.h"
#include "temporary_folder.h"

namespace {

using namespace ltmd;

/// A strip of quads along x, one unit square each, that covers the left three quarters of the tile;
/// corners of triangles are shared.
struct Strip {
    static constexpr int quads = 5;
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> corner_vert;
    std::vector<Vec2f> corner_uv;
    std::vector<Vec3f> rest;

    explicit Strip(float tile_u = 0) {
        for (int i = 0; i <= quads; ++i)
            for (const float y : {0.0f, 1.0f}) {
                corner_vert.push_back(static_cast<std::int32_t>(corner_vert.size()));
                corner_uv.push_back({tile_u + 0.75f * static_cast<float>(i) / quads, y});
                rest.push_back({static_cast<float>(i), y, 0});
            }
        for (int i = 0; i < quads; ++i) {
            const int low = 2 * i;
            triangles.push_back({low, low + 2, low + 3});
            triangles.push_back({low, low + 3, low + 1});
        }
    }
    MeshView view() const {
        return {triangles, corner_vert, corner_uv, static_cast<std::int32_t>(rest.size())};
    }

    /// Stretched by `s` along x, and sheared.
    std::vector<Vec3f> deformed(float s) const {
        std::vector<Vec3f> result = rest;
        for (Vec3f& p : result) p = {s * p[0] + 0.5f * p[1], p[1], 0};
        return result;
    }
    /// Each quad another stretch.
    std::vector<Vec3f> uneven() const {
        std::vector<Vec3f> result = rest;
        for (Vec3f& p : result) p[0] = 0.2f * p[0] * p[0] + p[0];
        return result;
    }
};

constexpr int width = 40, height = 24;

/// A file's texels must be the library's own bake, with the identity as background.
void expect_file(const std::string& path, const Strip& strip, const std::vector<Vec3f>& deformed,
                 Per per, const std::string& pass) {
    const RestState rest(strip.view(), strip.rest);
    std::vector<Tension> t(tension_count(rest, per));
    tension(rest, deformed, per, t);
    if (pass == "stretch") stretch(std::vector<Tension>(t), t);
    const TexelCoverage coverage(strip.view(), width, height, {}, 2);
    const std::vector<float> background =
        pass == "stretch" ? std::vector<float>{1, 1, 1} : std::vector<float>{1, 0, 1};
    const ExrImage image = read_exr(path);
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    ASSERT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    for (std::size_t i = 0; i < coverage.texels().size(); ++i) {
        const CoverageTexel& texel = coverage.texels()[i];
        for (std::size_t k = 0; k < 3; ++k) {
            double expected = background[k];
            if (texel.triangle >= 0) {
                const auto triangle = static_cast<std::size_t>(texel.triangle);
                const double b[3] = {texel.b0, texel.b1, 1.0 - texel.b0 - texel.b1};
                expected = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto corner = static_cast<std::size_t>(strip.triangles[triangle][c]);
                    const std::size_t item =
                        per == Per::triangle ? triangle
                        : per == Per::vertex ? static_cast<std::size_t>(strip.corner_vert[corner])
                                             : corner;
                    expected += b[c] * t[item][k];
                }
            }
            ASSERT_NEAR(image.pixels[4 * i + k], expected, 1e-6)
                << path << " texel " << i << " channel " << k;
        }
        ASSERT_EQ(image.pixels[4 * i + 3], 1.0f);
    }
}

TEST(SequenceBaker, WritesEachFrameOfEachPass) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    for (const Per per : {Per::corner, Per::vertex, Per::triangle})
        for (const int in_flight : {1, 2, 5}) {
            const TemporaryFolder folder;
            SequenceOptions options;
            options.passes = {"tension", "stretch"};
            options.per = per;
            options.in_flight = in_flight;
            options.margin = 2;
            SequenceBaker baker(strip.view(), rest, width, height, options);
            for (int f = 0; f < 7; ++f) {
                const auto deformed =
                    f == 6 ? strip.uneven() : strip.deformed(1 + 0.3f * static_cast<float>(f));
                baker.frame(deformed, {{"tension", folder / ("t" + std::to_string(f))},
                                       {"stretch", folder / ("s" + std::to_string(f))}});
            }
            baker.finish();
            EXPECT_EQ(baker.files_submitted(), 14u);
            EXPECT_EQ(baker.files_written(), 14u);
            EXPECT_EQ(folder.names().size(), 14u);
            for (int f = 0; f < 7; ++f) {
                const auto deformed =
                    f == 6 ? strip.uneven() : strip.deformed(1 + 0.3f * static_cast<float>(f));
                expect_file(folder / ("t" + std::to_string(f)), strip, deformed, per, "tension");
                expect_file(folder / ("s" + std::to_string(f)), strip, deformed, per, "stretch");
            }
        }
}

TEST(SequenceBaker, AFrameMayHaveItsOwnRestState) {
    const Strip strip, other = [] {
        Strip wide;
        for (Vec3f& p : wide.rest) p[0] *= 2;
        return wide;
    }();
    const TemporaryFolder folder;
    SequenceOptions options;
    options.margin = 2;
    const RestState rest(strip.view(), strip.rest);
    SequenceBaker baker(strip.view(), rest, width, height, options);
    baker.frame(strip.uneven(), {{"tension", folder / "own"}});
    baker.frame(RestState(other.view(), other.rest), strip.uneven(),
                {{"tension", folder / "other"}});
    MeshView fewer = strip.view();
    fewer.triangles = fewer.triangles.first(1);
    EXPECT_THROW(
        baker.frame(RestState(fewer, strip.rest), strip.uneven(), {{"tension", folder / "none"}}),
        InvalidInput);
    baker.finish();
    EXPECT_EQ(folder.names().size(), 2u);
    expect_file(folder / "own", strip, strip.uneven(), Per::corner, "tension");
    expect_file(folder / "other", other, strip.uneven(), Per::corner, "tension");
}

TEST(SequenceBaker, AUniformStretchIsReadBackAsItsMatrix) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    SequenceBaker baker(strip.view(), rest, width, height,
                        {.passes = {"tension", "stretch"}, .margin = 0});
    baker.frame(strip.deformed(2), {{"tension", folder / "t"}, {"stretch", folder / "s"}});
    baker.finish();
    // dP/du doubles; a unit across leans by half a unit along it.
    const ExrImage t = read_exr(folder / "t");
    const std::vector<float> inside(t.pixels.begin(), t.pixels.begin() + 4),
        outside(t.pixels.end() - 4, t.pixels.end());
    EXPECT_EQ(outside, (std::vector<float>{1, 0, 1, 1}));
    EXPECT_NEAR(inside[0], 2, 1e-6);
    EXPECT_NEAR(inside[1], 0.5, 1e-6);
    EXPECT_NEAR(inside[2], 1, 1e-6);
    const ExrImage s = read_exr(folder / "s");
    EXPECT_NEAR(s.pixels[2], 2, 1e-5);  // the area ratio
    EXPECT_EQ(std::vector<float>(s.pixels.end() - 4, s.pixels.end()),
              (std::vector<float>{1, 1, 1, 1}));
}

TEST(SequenceBaker, DescribesEachFile) {
    const Strip strip(2);
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    SequenceOptions options;
    options.tile = {2, 0};
    options.per = Per::vertex;
    options.metadata = {{"ltmd:object", "Balloon"}, {"ltmd:frame", "0"}, {"ltmd:convention", "7"}};
    SequenceBaker baker(strip.view(), rest, width, height, options);
    EXPECT_GT(baker.coverage().covered(), 0u);
    baker.frame(strip.rest, {{"tension", folder / "a.exr"}},
                {{"ltmd:frame", "12"}, {"ltmd:pass", "other"}, {"ltmd:convention", "9"}});
    baker.finish();
    Metadata metadata = exr_metadata(folder / "a.exr");
    EXPECT_EQ(metadata["ltmd:convention"], "1");
    EXPECT_EQ(metadata["ltmd:pass"], "tension");
    EXPECT_EQ(metadata["ltmd:per"], "vertex");
    EXPECT_EQ(metadata["ltmd:udim"], "1003");
    EXPECT_EQ(metadata["ltmd:object"], "Balloon");
    EXPECT_EQ(metadata["ltmd:frame"], "12");
    EXPECT_FALSE(metadata["ltmd:version"].empty());

    options.tile = {-1, 0};
    SequenceBaker no_udim(strip.view(), rest, width, height, options);
    no_udim.frame(strip.rest, {{"tension", folder / "b.exr"}});
    no_udim.finish();
    EXPECT_FALSE(exr_metadata(folder / "b.exr").contains("ltmd:udim"));
}

TEST(SequenceBaker, TheFirstWritersErrorReachesTheCaller) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    {
        SequenceBaker baker(strip.view(), rest, width, height);
        baker.frame(strip.rest, {{"tension", folder / "missing/a.exr"}});
        EXPECT_THROW(baker.finish(), FileError);
        EXPECT_THROW(baker.finish(), FileError);
        EXPECT_EQ(baker.files_written(), 0u);
    }
    {
        SequenceBaker baker(strip.view(), rest, width, height, {.in_flight = 1});
        baker.frame(strip.rest, {{"tension", folder / "missing/a.exr"}});
        // The second frame can only start when the first has failed.
        EXPECT_THROW(baker.frame(strip.rest, {{"tension", folder / "b.exr"}}), FileError);
        EXPECT_THROW(baker.finish(), FileError);
    }
    EXPECT_TRUE(folder.names().empty());
}

TEST(SequenceBaker, ABadFrameHarmsNoOther) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    SequenceBaker baker(strip.view(), rest, width, height, {.in_flight = 1});
    std::vector<Vec3f> bad = strip.rest;
    bad[3][1] = std::numeric_limits<float>::quiet_NaN();
    for (int i = 0; i < 3; ++i) {
        EXPECT_THROW(baker.frame(bad, {{"tension", folder / "bad.exr"}}), InvalidInput);
        EXPECT_THROW(baker.frame(std::span(strip.rest).first(3), {{"tension", folder / "bad.exr"}}),
                     InvalidInput);
        EXPECT_THROW(baker.frame(strip.rest, {{"stretch", folder / "bad.exr"}}), InvalidInput);
        EXPECT_THROW(baker.frame(strip.rest, {}), InvalidInput);
        baker.frame(strip.rest, {{"tension", folder / ("good" + std::to_string(i))}});
    }
    baker.finish();
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"good0", "good1", "good2"}));
    EXPECT_THROW(baker.frame(strip.rest, {{"tension", folder / "late.exr"}}), InvalidInput);
}

TEST(SequenceBaker, CancelLeavesOnlyWholeFiles) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    SequenceBaker baker(strip.view(), rest, 1024, 1024, {.in_flight = 3});
    std::size_t accepted = 0;
    std::jthread other([&] {
        while (baker.files_written() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        baker.cancel();
    });
    EXPECT_THROW(
        for (;;) {
            baker.frame(strip.deformed(2), {{"tension", folder / std::to_string(accepted)}});
            ++accepted;
        },
        Cancelled);
    EXPECT_THROW(baker.finish(), Cancelled);
    EXPECT_EQ(baker.files_submitted(), accepted);
    EXPECT_GE(baker.files_written(), 2u);
    EXPECT_LT(baker.files_written(), accepted + 1);
    EXPECT_EQ(folder.names().size(), baker.files_written());
    for (const std::string& name : folder.names())
        EXPECT_EQ(read_exr(folder / name).width, 1024) << name;
}

TEST(SequenceBaker, CancelDropsWhatIsQueued) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    set_thread_count(2);  // two writers
    SequenceBaker baker(strip.view(), rest, 512, 512, {.in_flight = 12});
    for (int i = 0; i < 12; ++i)
        baker.frame(strip.deformed(2), {{"tension", folder / std::to_string(i)}});
    baker.cancel();
    const std::size_t written = baker.files_written();
    EXPECT_THROW(baker.finish(), Cancelled);
    EXPECT_LE(baker.files_written(), written + 2);
    EXPECT_EQ(folder.names().size(), baker.files_written());
    set_thread_count(0);
}

TEST(SequenceBaker, DestructionDropsTheQueueAndWaits) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    {
        SequenceBaker baker(strip.view(), rest, 512, 512, {.in_flight = 4});
        for (int i = 0; i < 4; ++i)
            baker.frame(strip.deformed(2), {{"tension", folder / std::to_string(i)}});
    }
    for (const std::string& name : folder.names())
        EXPECT_EQ(read_exr(folder / name).width, 512) << name;
    const std::size_t now = folder.names().size();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(folder.names().size(), now);
}

TEST(SequenceBaker, HasTheSameBitsForAnyThreadCount) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const TemporaryFolder folder;
    std::vector<std::vector<float>> pixels;
    for (const int threads : {1, 4}) {
        set_thread_count(threads);
        SequenceBaker baker(strip.view(), rest, 200, 300);
        baker.frame(strip.uneven(), {{"tension", folder / "a.exr"}});
        baker.finish();
        pixels.push_back(read_exr(folder / "a.exr").pixels);
    }
    set_thread_count(0);
    EXPECT_EQ(std::memcmp(pixels[0].data(), pixels[1].data(), pixels[0].size() * sizeof(float)), 0);
}

TEST(SequenceBaker, RefusesWhatItCannotDo) {
    const Strip strip;
    const RestState rest(strip.view(), strip.rest);
    const auto refuses = [&](const SequenceOptions& options) {
        EXPECT_THROW(SequenceBaker(strip.view(), rest, width, height, options), InvalidInput);
    };
    refuses({.passes = {"tensoin"}});
    refuses({.passes = {}});
    refuses({.passes = {"stretch", "stretch"}});
    refuses({.margin = 65});
    refuses({.in_flight = 0});
    refuses({.in_flight = 17});
    EXPECT_THROW(SequenceBaker(strip.view(), rest, 0, height), InvalidInput);
    MeshView other = strip.view();
    other.triangles = other.triangles.first(3);
    EXPECT_THROW(SequenceBaker(other, rest, width, height), InvalidInput);
    refuses({.precision = {.mantissa_bits = 0}});
    refuses({.lobe = {.alpha_x = 0}});
    refuses({.lobe = {.m0 = {1, 2, 2, 4}}});
}

}  // namespace
