// SPDX-License-Identifier: Apache-2.0
#include "ltmd/exr.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/threads.h"
#include "temporary_folder.h"

#if defined(__unix__)
#include <sys/resource.h>

#include <csignal>
#endif

namespace {

using namespace ltmd;
namespace fs = std::filesystem;

const std::vector<std::string> rgba = {"R", "G", "B", "A"};

std::vector<float> noise(std::size_t count, unsigned seed = 0) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::vector<float> values(count);
    for (float& v : values) v = normal(random);
    return values;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

std::string message_of(const auto& work) {
    try {
        work();
    } catch (const FileError& error) {
        return error.what();
    }
    return "no FileError";
}

void expect_contains(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

TEST(Exr, RoundsToTheNearestEvenMantissa) {
    const TemporaryFolder folder;
    constexpr float largest = std::numeric_limits<float>::max(),
                    infinity = std::numeric_limits<float>::infinity();
    const auto stored = [&](const std::vector<float>& pixels, const Precision& precision) {
        write_exr(folder / "a.exr", pixels, static_cast<int>(pixels.size()), 1,
                  std::vector<std::string>{"Y"}, Compression::zip, {}, precision);
        return read_exr(folder / "a.exr").pixels;
    };
    // Two bits: 1, 1.25, 1.5, 1.75; halfway goes to the even one.
    EXPECT_EQ(stored({1.125f, 1.126f, 1.375f, -1.124f, 1.9f, 0, largest, -largest, infinity},
                     {.mantissa_bits = 2}),
              (std::vector<float>{1, 1.25f, 1.5f, -1, 2, 0, 0x1.cp127f, -0x1.cp127f, infinity}));
    EXPECT_EQ(stored({1.0f + 0x1p-11f, 1.0f + 0x1.8p-11f, 7e4f, -largest, 65504, 0x1p-24f},
                     {.half = true}),
              (std::vector<float>{1, 1.0f + 0x1p-10f, 65504, -65504, 65504, 0x1p-24f}));
    const std::vector<float> values = noise(300 * 17);
    for (int bits = 1; bits <= 23; ++bits) {
        const std::vector<float> result = stored(values, {.mantissa_bits = bits});
        for (std::size_t i = 0; i < values.size(); ++i) {
            int exponent;
            std::frexp(values[i], &exponent);
            const double step = std::ldexp(1.0, exponent - 1 - bits);
            ASSERT_EQ(result[i], std::nearbyint(values[i] / step) * step) << bits;
        }
    }
    // More rows than are converted at a time, each with its own value.
    std::vector<float> rows;
    for (int i = 0; i < 600; ++i) rows.insert(rows.end(), 8, static_cast<float>(i));
    write_exr(folder / "b.exr", rows, 2, 600, rgba, Compression::piz, {}, {.half = true});
    EXPECT_EQ(read_exr(folder / "b.exr").pixels, rows);
}

TEST(Exr, RoundTripIsBitEqual) {
    const TemporaryFolder folder;
    std::vector<float> pixels = noise(67 * 45 * 4);
    pixels[0] = 0.0f, pixels[1] = -0.0f, pixels[2] = std::numeric_limits<float>::denorm_min();
    pixels[3] = std::numeric_limits<float>::max(), pixels[4] = -1e-38f;
    pixels[5] = std::numeric_limits<float>::infinity(),
    pixels[6] = std::numeric_limits<float>::quiet_NaN();
    for (const int threads : {1, 3})
        for (const Compression compression :
             {Compression::none, Compression::zips, Compression::zip, Compression::piz}) {
            set_thread_count(threads);
            write_exr(folder / "a.exr", pixels, 67, 45, rgba, compression);
            const ExrImage image = read_exr(folder / "a.exr");
            EXPECT_EQ(image.width, 67);
            EXPECT_EQ(image.height, 45);
            EXPECT_EQ(image.channels, rgba);
            EXPECT_TRUE(same_bits(image.pixels, pixels));
            EXPECT_EQ(exr_size(folder / "a.exr"), (std::array{67, 45}));
        }
    set_thread_count(0);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
}

TEST(Exr, OnePixelAndOddChannels) {
    const TemporaryFolder folder;
    write_exr(folder / "y.exr", std::vector<float>{0.25f}, 1, 1, std::vector<std::string>{"Y"});
    EXPECT_EQ(read_exr(folder / "y.exr").channels, std::vector<std::string>{"Y"});
    EXPECT_EQ(read_exr(folder / "y.exr").pixels, std::vector<float>{0.25f});

    const std::vector<std::string> mixed = {"zz", "B", "A", "aa", "R"};
    write_exr(folder / "m.exr", std::vector<float>{1, 2, 3, 4, 5}, 1, 1, mixed);
    const ExrImage image = read_exr(folder / "m.exr");
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "B", "A", "aa", "zz"}));
    EXPECT_EQ(image.pixels, (std::vector<float>{5, 2, 3, 4, 1}));
}

TEST(Exr, AChannelThatIsLeftOutIsOne) {
    const TemporaryFolder folder;
    constexpr int width = 5, height = 300;
    const std::vector<float> pixels = noise(width * height * 3);
    for (const Precision& precision :
         {Precision{}, Precision{.half = true}, Precision{.mantissa_bits = 8}}) {
        write_exr(folder / "three.exr", pixels, width, height, rgba, Compression::zip, {},
                  precision);
        std::vector<float> four;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            four.push_back(pixels[i]);
            if (i % 3 == 2) four.push_back(1);
        }
        write_exr(folder / "four.exr", four, width, height, rgba, Compression::zip, {}, precision);
        EXPECT_EQ(read_exr(folder / "three.exr").pixels, read_exr(folder / "four.exr").pixels);
    }
}

TEST(Exr, KeepsMetadata) {
    const TemporaryFolder folder;
    const Metadata metadata = {{"ltmd:convention", "1"},
                               {"ltmd:object", "Ballon \xC3\xA9l\xC3\xA9"},
                               {"empty", ""},
                               {"long", std::string(5000, 'x')},
                               {std::string(255, 'k'), "long key"}};
    write_exr(folder / "a.exr", noise(16), 2, 2, rgba, Compression::zip, metadata);
    Metadata read = exr_metadata(folder / "a.exr");
    for (const auto& [key, value] : metadata) EXPECT_EQ(read[key], value) << key;
    EXPECT_EQ(read["pixelAspectRatio"], "1");
}

TEST(Exr, ReplacesAFileWhole) {
    const TemporaryFolder folder;
    write_exr(folder / "a.exr", noise(64 * 64 * 4), 64, 64, rgba);
    write_exr(folder / "a.exr", noise(4), 1, 1, rgba);
    EXPECT_EQ(exr_size(folder / "a.exr"), (std::array{1, 1}));
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
}

TEST(Exr, TakesNamesInUtf8AndOfFullLength) {
    const TemporaryFolder folder;
    for (const std::string& name :
         {std::string("\xE6\xB0\x94\xE7\x90\x83 1.exr"), std::string(251, 'n') + ".exr"}) {
        write_exr(folder / name, noise(4), 1, 1, rgba);
        EXPECT_TRUE(same_bits(read_exr(folder / name).pixels, noise(4)));
    }
}

TEST(Exr, ParallelWritersOfOneFileLeaveOneWholeFile) {
    const TemporaryFolder folder;
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 0; i < 4; ++i)
            threads.emplace_back([&, i] {
                for (int k = 0; k < 5; ++k)
                    write_exr(folder / "a.exr", noise(40 * 40 * 4, i), 40, 40, rgba);
            });
    }
    const ExrImage image = read_exr(folder / "a.exr");
    bool one_of_them = false;
    for (unsigned i = 0; i < 4; ++i)
        one_of_them = one_of_them || same_bits(image.pixels, noise(40 * 40 * 4, i));
    EXPECT_TRUE(one_of_them);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
}

TEST(Exr, SaysWhyAPathCannotBeWritten) {
    const TemporaryFolder folder;
    const auto write = [&](const std::string& path) {
        return message_of([&] { write_exr(path, noise(4), 1, 1, rgba); });
    };
    const std::string missing = folder / "no/such/a.exr";
    expect_contains(write(missing), missing + ": the folder ");
    expect_contains(write(missing), "does not exist: create it");
    std::ofstream(folder / "file") << "text";
    expect_contains(write(folder / "file/a.exr"), "is a file");
    fs::create_directory(folder / "sub.exr");
    expect_contains(write(folder / "sub.exr"), "is a folder");
    expect_contains(write(folder / "sub.exr/"), "no file name");
    expect_contains(write(""), "no file name");
    expect_contains(write(folder / (std::string(300, 'n') + ".exr")), "could not be put in place");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"file", "sub.exr"}));
}

#if defined(__unix__)
/// Stands in for a full disk: no file may grow beyond `bytes`.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, old_handler_);
    }

private:
    rlimit old_{};
    void (*old_handler_)(int);
};

TEST(Exr, AFullDiskLeavesTheOldFile) {
    const TemporaryFolder folder;
    const std::vector<float> old = noise(16);
    write_exr(folder / "a.exr", old, 2, 2, rgba);
    const std::vector<float> pixels = noise(64 * 64 * 4);
    std::uintmax_t whole = 0;
    {
        write_exr(folder / "whole.exr", pixels, 64, 64, rgba);
        whole = fs::file_size(folder / "whole.exr");
        fs::remove(folder / "whole.exr");
    }
    // At the start, in the middle, and in the very last bytes, which leave with the closing of the
    // file.
    for (const std::uintmax_t room :
         {std::uintmax_t{0}, std::uintmax_t{100}, whole / 2, whole - 1}) {
        std::string message;
        {
            const FileSizeLimit limit(room);
            message = message_of([&] { write_exr(folder / "a.exr", pixels, 64, 64, rgba); });
        }
        expect_contains(message, (folder / "a.exr") + ": could not be written (");
        expect_contains(message, "make room");
        EXPECT_TRUE(same_bits(read_exr(folder / "a.exr").pixels, old)) << room;
        EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"}) << room;
    }
    {
        // A file that fits into the stream's buffer meets the disk after its last row.
        const FileSizeLimit limit(50);
        expect_contains(message_of([&] { write_exr(folder / "a.exr", old, 2, 2, rgba); }),
                        "make room");
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
    const FileSizeLimit enough(whole);
    EXPECT_NO_THROW(write_exr(folder / "a.exr", pixels, 64, 64, rgba));
}
#endif

TEST(Exr, RefusesDamagedFiles) {
    const TemporaryFolder folder;
    expect_contains(message_of([&] { read_exr(folder / "none.exr"); }), "does not exist");
    expect_contains(message_of([&] { read_exr(folder / ""); }), "is a folder");
    std::ofstream(folder / "text.exr") << "not a picture";
    std::ofstream(folder / "empty.exr");
    for (const char* name : {"text.exr", "empty.exr"}) {
        expect_contains(message_of([&] { read_exr(folder / name); }),
                        (folder / name) + ": is no OpenEXR file");
        expect_contains(message_of([&] { exr_metadata(folder / name); }),
                        (folder / name) + ": is no OpenEXR file");
    }
    write_exr(folder / "whole.exr", noise(64 * 64 * 4), 64, 64, rgba);
    const auto whole = static_cast<std::size_t>(fs::file_size(folder / "whole.exr"));
    for (const std::size_t size :
         {std::size_t{5}, std::size_t{100}, std::size_t{400}, whole / 2, whole - 1}) {
        fs::copy_file(folder / "whole.exr", folder / "cut.exr",
                      fs::copy_options::overwrite_existing);
        fs::resize_file(folder / "cut.exr", size);
        expect_contains(message_of([&] { read_exr(folder / "cut.exr"); }), "damaged or cut short");
    }
}

TEST(Exr, RefusesANewerConvention) {
    const TemporaryFolder folder;
    const auto write = [&](const char* number) {
        write_exr(folder / "a.exr", noise(4), 1, 1, rgba, Compression::zip,
                  {{"ltmd:convention", number}});
    };
    write("1");
    EXPECT_NO_THROW(read_exr(folder / "a.exr"));
    write("2");
    const std::string expected =
        (folder / "a.exr") +
        ": was written with convention 2; this version reads up to 1: update LTMD";
    EXPECT_EQ(message_of([&] { read_exr(folder / "a.exr"); }), expected);
    EXPECT_EQ(message_of([&] { exr_metadata(folder / "a.exr"); }), expected);
    EXPECT_EQ(message_of([&] { exr_size(folder / "a.exr"); }), expected);
    for (const char* wrong : {"", "one", "1.5", "0", "99999999999"}) {
        write(wrong);
        expect_contains(message_of([&] { read_exr(folder / "a.exr"); }), "is not a whole number");
    }
}

TEST(Exr, RefusesWrongInput) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    const std::vector<float> pixels(16);
    for (const int bits : {0, 24, -1})
        EXPECT_THROW(
            write_exr(path, pixels, 2, 2, rgba, Compression::zip, {}, {.mantissa_bits = bits}),
            InvalidInput);
    EXPECT_THROW(write_exr(path, pixels, 2, 3, rgba), InvalidInput);
    EXPECT_THROW(write_exr(path, {}, 0, 2, rgba), InvalidInput);
    EXPECT_THROW(write_exr(path, {}, 65537, 0, rgba), InvalidInput);
    EXPECT_THROW(write_exr(path, {}, 2, 2, {}), InvalidInput);
    EXPECT_THROW(write_exr(path, pixels, 4, 1, std::vector<std::string>{"R", "G", "B", "R"}),
                 InvalidInput);
    EXPECT_THROW(write_exr(path, pixels, 4, 1, std::vector<std::string>{"R", "G", "B", ""}),
                 InvalidInput);
    for (const std::string& key :
         {std::string(), std::string("channels"), std::string("dataWindow"), std::string("type"),
          std::string("chunkCount"), std::string(256, 'k')})
        EXPECT_THROW(write_exr(path, pixels, 2, 2, rgba, Compression::zip, {{key, "x"}}),
                     InvalidInput)
            << key;
    EXPECT_TRUE(folder.names().empty());
}

}  // namespace
