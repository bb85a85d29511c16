// SPDX-License-Identifier: Apache-2.0
#include "ltmd/verify.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/exr.h"
#include "temporary_folder.h"

namespace {

using namespace ltmd;
namespace fs = std::filesystem;

constexpr int size = 8;

std::vector<float> identity_pixels(int side = size) {
    std::vector<float> pixels;
    for (int i = 0; i < side * side; ++i) pixels.insert(pixels.end(), {1, 0, 1, 1});
    return pixels;
}

std::string frame_name(const std::string& sequence, int frame) {
    char digits[16];
    std::snprintf(digits, sizeof digits, "%04d", frame);
    return sequence + "." + digits + ".exr";
}

void write(const TemporaryFolder& folder, const std::string& name,
           const std::vector<float>& pixels = identity_pixels(), const Metadata& metadata = {},
           int side = size) {
    Metadata all = {{"ltmd:convention", "1"}, {"ltmd:pass", "tension"}, {"ltmd:per", "corner"}};
    for (const auto& [key, value] : metadata) all[key] = value;
    write_exr(folder / name, pixels, side, side, std::vector<std::string>{"R", "G", "B", "A"},
              Compression::zip, all);
}

void write_frames(const TemporaryFolder& folder, const std::string& sequence,
                  const std::vector<int>& frames, const Metadata& metadata = {}) {
    for (const int frame : frames)
        write(folder, frame_name(sequence, frame), identity_pixels(), metadata);
}

using Problems = std::vector<std::string>;

TEST(Verify, AcceptsWholeSequences) {
    const TemporaryFolder folder;
    write_frames(folder, "balloon_tension", {3, 1, 2},
                 {{"ltmd:frame_start", "1"}, {"ltmd:frame_end", "3"}});
    write_frames(folder, "balloon_tension.1001", {10000, 9999});
    write_frames(folder, "balloon_tension.1002", {-2, -1, 0, 1});
    write_exr(folder / "other.0001.exr", identity_pixels(), size, size,
              std::vector<std::string>{"R", "G", "B", "A"});
    std::ofstream(folder / "notes.txt") << "text";
    std::ofstream(folder / "no_frame.exr") << "text";
    fs::create_directory(folder / "folder.0001.exr");
    const VerifyReport report = verify(folder.string());
    EXPECT_EQ(report.problems, Problems());
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.sequences,
              (std::map<std::string, std::vector<int>>{{"balloon_tension", {1, 2, 3}},
                                                       {"balloon_tension.1001", {9999, 10000}},
                                                       {"balloon_tension.1002", {-2, -1, 0, 1}}}));
}

TEST(Verify, NamesMissingFrames) {
    const TemporaryFolder folder;
    write_frames(folder, "balloon_tension", {1, 2, 6, 8});
    EXPECT_EQ(
        verify(folder.string()).problems,
        (Problems{
            "balloon_tension: frames 3 to 5 are missing (they would render as undeformed): bake "
            "them again",
            "balloon_tension: frame 7 is missing (it would render as undeformed): bake it again"}));
    EXPECT_EQ(verify(folder.string(), {1, 2, 6, 6}).problems, Problems());
    EXPECT_EQ(
        verify(folder.string(), {9, 0, 3, 2}).problems,
        (Problems{
            "balloon_tension: frame 0 is missing (it would render as undeformed): bake it again",
            "balloon_tension: frame 3 is missing (it would render as undeformed): bake it again",
            "balloon_tension: frame 9 is missing (it would render as undeformed): bake it again"}));
    EXPECT_EQ(verify(folder.string(), {3, 4, 10, 11}).problems.size(), 2u);
}

TEST(Verify, TheFilesOwnRangeShowsAnUnfinishedBake) {
    const TemporaryFolder folder;
    write_frames(folder, "a_tension", {5, 6},
                 {{"ltmd:frame_start", "4"}, {"ltmd:frame_end", "2000000000"}});
    EXPECT_EQ(
        verify(folder.string()).problems,
        (Problems{"a_tension: frame 4 is missing (it would render as undeformed): bake it again",
                  "a_tension: frames 7 to 2000000000 are missing (they would render as "
                  "undeformed): bake them again"}));
}

TEST(Verify, FindsBrokenFiles) {
    const TemporaryFolder folder;
    write_frames(folder, "a_tension", {1, 2, 3, 4});
    fs::resize_file(folder / "a_tension.0002.exr",
                    fs::file_size(folder / "a_tension.0002.exr") - 20);
    std::ofstream(folder / "a_tension.0003.exr", std::ios::trunc);
    write(folder, "a_tension.0004.exr", identity_pixels(), {{"ltmd:convention", "2"}});
    const VerifyReport report = verify(folder.string());
    ASSERT_EQ(report.problems.size(), 3u);
    EXPECT_EQ(report.problems[0].find(folder / "a_tension.0003.exr: is no OpenEXR file"), 0u)
        << report.problems[0];
    EXPECT_NE(report.problems[1].find("convention 2"), std::string::npos) << report.problems[1];
    EXPECT_EQ(report.problems[2].find(folder / "a_tension.0002.exr: is no OpenEXR file"), 0u)
        << report.problems[2];
    EXPECT_EQ(report.sequences.at("a_tension"), (std::vector<int>{1, 2, 3, 4}));
}

TEST(Verify, FindsBadValues) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    struct Case {
        std::size_t channel;
        float value;
        std::string problem;
    };
    const std::string place = " in 1 pixel, first at column 3, row 2: bake it again";
    for (const Case& c : {Case{1, nan, "a value that is not finite" + place},
                          {3, infinity, "a value that is not finite" + place},
                          {0, 0.0009f, "a tension with a diagonal outside 0.001 to 1000" + place},
                          {2, -1.0f, "a tension with a diagonal outside 0.001 to 1000" + place},
                          {2, 1000.5f, "a tension with a diagonal outside 0.001 to 1000" + place},
                          {3, 0.5f, "an alpha other than 1" + place},
                          {0, 0.001f, ""},
                          {2, 1000.0f, ""},
                          {1, -50.0f, ""}}) {
        const TemporaryFolder folder;
        std::vector<float> pixels = identity_pixels();
        pixels[4 * (2 * size + 3) + c.channel] = c.value;
        write(folder, "a_tension.0001.exr", pixels);
        EXPECT_EQ(verify(folder.string()).problems,
                  c.problem.empty() ? Problems() : Problems{"a_tension: frame 1 has " + c.problem});
        // An unknown pass may hold any numbers.
        write(folder, "a_tension.0001.exr", pixels, {{"ltmd:pass", "other"}});
        EXPECT_EQ(verify(folder.string()).ok(),
                  c.problem.find("diagonal") != std::string::npos || c.problem.empty());
    }
}

TEST(Verify, KnowsWhatEachPassCanHold) {
    const std::string stretches = "stretches that are not positive, the larger first",
                      wrinkles = "a stretch outside 0.001 to 1000 or a shear beyond a right angle",
                      matrices = "an alpha^2 matrix that is not positive",
                      alphas =
                          "alphas that are not positive, the smaller first, or a direction "
                          "beyond 1";
    struct Case {
        std::string pass;
        std::array<float, 4> pixel;
        std::string problem;
    };
    for (const Case& c : {Case{"stretch", {2, 0.5f, 1, 1}, ""},
                          {"stretch", {0.5f, 2, 1, 1}, stretches},
                          {"stretch", {2, 0, 1, 1}, stretches},
                          {"wrinkle", {2, 0.5f, -1.5f, 1}, ""},
                          {"wrinkle", {2, 0.5f, 1.6f, 1}, wrinkles},
                          {"wrinkle", {0, 1, 0, 1}, wrinkles},
                          {"alpha2", {0.04f, -0.039f, 0.04f, 1}, ""},
                          {"alpha2", {0.04f, 0.041f, 0.04f, 1}, matrices},
                          {"alpha2", {0.04f, 0, 0, 1}, matrices},
                          {"roughness", {0.1f, 3, -0.6f, 0.8f}, ""},
                          {"roughness", {0.1f, 3, 0, 0}, ""},
                          {"roughness", {3, 0.1f, 1, 0}, alphas},
                          {"roughness", {0, 0.1f, 1, 0}, alphas},
                          {"roughness", {1, 1, 0.9f, 0.9f}, alphas},
                          {"alpha2", {0.04f, 0, 0.04f, 0}, "an alpha other than 1"}}) {
        const TemporaryFolder folder;
        const std::vector<float> pixels(c.pixel.begin(), c.pixel.end());
        write(folder, "a.0001.exr", pixels, {{"ltmd:pass", c.pass}}, 1);
        EXPECT_EQ(verify(folder.string()).problems,
                  c.problem.empty() ? Problems()
                                    : Problems{"a: frame 1 has " + c.problem +
                                               " in 1 pixel, first at column 0, row 0: bake it "
                                               "again"})
            << c.pass;
    }
}

TEST(Verify, AllowsForTheStatedRounding) {
    const TemporaryFolder folder;
    const std::vector<float> pixels = {1001.0f, 0, 1, 1};
    write(folder, "a.0001.exr", pixels, {{"ltmd:mantissa_bits", "9"}}, 1);
    EXPECT_TRUE(verify(folder.string()).ok());
    write(folder, "a.0001.exr", pixels, {{"ltmd:mantissa_bits", "12"}}, 1);
    EXPECT_FALSE(verify(folder.string()).ok());
}

TEST(Verify, FindsFramesThatDoNotBelongTogether) {
    const TemporaryFolder folder;
    write_frames(folder, "a_tension", {1, 2, 3, 4});
    write(folder, "a_tension.0002.exr", identity_pixels(16), {}, 16);
    write(folder, "a_tension.0003.exr", identity_pixels(), {{"ltmd:per", "vertex"}});
    write(folder, "a_tension.0004.exr", identity_pixels(), {{"ltmd:frame", "7"}});
    write(folder, "a_tension.00001.exr");
    EXPECT_EQ(verify(folder.string()).problems,
              (Problems{"a_tension: frame 1 has two files, a_tension.00001.exr and "
                        "a_tension.0001.exr: delete one",
                        "a_tension: frame 2 is 16 x 16, frame 1 is 8 x 8: bake one of them again",
                        "a_tension: frame 3 has ltmd:per 'vertex', frame 1 has 'corner': bake one "
                        "of them again",
                        "a_tension: frame 4 says in its header that it is frame 7: it was renamed, "
                        "or copied over another; bake it "
                        "again"}));
}

TEST(Verify, NeedsTheChannels) {
    const TemporaryFolder folder;
    write_exr(folder / "a.0001.exr", std::vector<float>(4, 1.0f), 2, 2,
              std::vector<std::string>{"Y"}, Compression::zip,
              {{"ltmd:convention", "1"}, {"ltmd:pass", "tension"}});
    EXPECT_EQ(
        verify(folder.string()).problems,
        (Problems{"a: frame 1 has no channel A: Blender needs it; bake it again",
                  "a: frame 1 has no channels R, G, B, so it holds no tension: bake it again"}));
}

TEST(Verify, LooksAtTheNamedSequencesAndFramesAlone) {
    const TemporaryFolder folder;
    const Metadata ours = {{"ltmd:convention", "1"}, {"ltmd:pass", "tension"}};
    const std::vector<std::string> channels = {"R", "G", "B", "A"};
    const std::vector<float> good = {1, 0, 1, 1}, bad = {0, 0, 1, 1};
    write_exr(folder / "a.0001.exr", good, 1, 1, channels, Compression::zip, ours);
    write_exr(folder / "a.0002.exr", bad, 1, 1, channels, Compression::zip, ours);
    write_exr(folder / "b.0001.exr", bad, 1, 1, channels, Compression::zip, ours);
    EXPECT_EQ(verify(folder.string()).problems.size(), 2u);
    EXPECT_EQ(verify(folder.string(), {}, {"a"}).problems.size(), 1u);
    EXPECT_TRUE(verify(folder.string(), {1}, {"a"}).ok());
    EXPECT_EQ(verify(folder.string(), {1}, {"a", "c"}).problems,
              Problems{"c: has no file: bake it"});
}

TEST(Verify, AFolderWithoutSequences) {
    const TemporaryFolder folder;
    const VerifyReport report = verify(folder.string());
    ASSERT_EQ(report.problems.size(), 1u);
    EXPECT_EQ(report.problems[0].find(folder.string() + ": holds no baked sequence"), 0u);
    EXPECT_THROW(verify(folder / "missing"), FileError);
    std::ofstream(folder / "file") << "text";
    EXPECT_THROW(verify(folder / "file"), FileError);
}

}  // namespace
