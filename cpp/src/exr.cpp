// SPDX-License-Identifier: Apache-2.0
#include "ltmd/exr.h"

#if __has_include(<ImfContextInit.h>)  // OpenEXR 3.3
#include <ImfContextInit.h>
#define LTMD_HAS_EXR_CONTEXT
#endif
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <half.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <random>
#include <set>
#include <sstream>
#include <system_error>

#include "ltmd/errors.h"
#include "ltmd/threads.h"
#include "parallel.h"
#include "utf8_path.h"

namespace ltmd::inline v0 {
namespace {

namespace fs = std::filesystem;

constexpr int max_size = 65536;
constexpr std::size_t max_name_length = 255;  // of OpenEXR's file format
constexpr const char* convention_key = "ltmd:convention";

[[noreturn]] void fail(const std::string& path, const std::string& what) {
    throw FileError(path + ": " + what);
}

std::string error_text(int error) { return std::generic_category().message(error); }

/// The worker threads that a file may keep busy. OpenEXR's pool (our own copy of it) only grows:
/// shrinking it waits for others.
int file_threads() {
    const int count = thread_count();
    if (count < 2) return 0;
    static std::mutex mutex;
    std::lock_guard lock(mutex);
    if (Imf::globalThreadCount() < count) Imf::setGlobalThreadCount(count);
    return count;
}

/// A file under a temporary name in the folder of its final path; removed unless it is published.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& path) : text_(path), path_(utf8_path(path)) {
        const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
        std::error_code error;
        if (!path_.has_filename()) fail(text_, "is no file name");
        if (!fs::is_directory(folder, error))
            fail(text_, "the folder " + utf8_text(folder) +
                            (fs::exists(folder, error) ? " is a file: give another path"
                                                       : " does not exist: create it first"));
        if (fs::is_directory(path_, error)) fail(text_, "is a folder: give another path");
        temporary_ = folder / temporary_name();
        errno = 0;
        stream_.open(temporary_, std::ios::binary | std::ios::trunc);
        if (!stream_)
            fail(text_, "cannot be created (" + error_text(errno) +
                            "): check that its folder may be written to");
    }
    ~TemporaryFile() {
        if (published_) return;
        stream_.close();
        std::error_code ignored;
        fs::remove(temporary_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    std::ofstream& stream() { return stream_; }

    /// Remembers the first failure's reason.
    void check() {
        if (!stream_ && error_ == 0) error_ = errno != 0 ? errno : EIO;
    }

    void publish() {
        errno = 0;
        stream_.close();
        check();
        if (error_ != 0)
            fail(text_, "could not be written (" + error_text(error_) +
                            "): make room or choose another folder, then write it again");
        std::error_code error;
        fs::rename(temporary_, path_, error);
        if (error)
            fail(text_, "could not be put in place (" + error.message() +
                            "): check that no other program holds the old file and that the folder "
                            "may be written to");
        published_ = true;
    }

private:
    static std::string temporary_name() {
        std::random_device random;
        char name[40];
        std::snprintf(name, sizeof name, ".ltmd-%08x%08x.tmp", unsigned{random()},
                      unsigned{random()});
        return name;
    }

    std::string text_;
    fs::path path_, temporary_;
    std::ofstream stream_;
    int error_ = 0;
    bool published_ = false;
};

/// OpenEXR swallows errors in its destructor, where the last bytes are written: this stream keeps
/// the first one, never throws, and is asked at the end.
class FileStream : public Imf::OStream {
public:
    FileStream(TemporaryFile& file, const std::string& path) : OStream(path.c_str()), file_(file) {}

    void write(const char data[], int size) override {
        errno = 0;
        file_.stream().write(data, size);
        file_.check();
        position_ += static_cast<std::uint64_t>(size);
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override {
        errno = 0;
        file_.stream().seekp(static_cast<std::streamoff>(position));
        file_.check();
        position_ = position;
    }

private:
    TemporaryFile& file_;
    std::uint64_t position_ = 0;  // the stream's own is unknown after a failure
};

Imf::Compression imf_compression(Compression compression) {
    switch (compression) {
        case Compression::none:
            return Imf::NO_COMPRESSION;
        case Compression::zips:
            return Imf::ZIPS_COMPRESSION;
        case Compression::zip:
            return Imf::ZIP_COMPRESSION;
        case Compression::piz:
            return Imf::PIZ_COMPRESSION;
    }
    throw InvalidInput("unknown compression");
}

void validate_name(const char* what, const std::string& name) {
    if (name.empty() || name.size() > max_name_length || name.find('\0') != std::string::npos)
        throw InvalidInput(std::string(what) + " '" + name + "' must have 1 to " +
                           std::to_string(max_name_length) + " bytes, none of them zero");
}

Imf::Header make_header(int width, int height, std::span<const std::string> channels,
                        Compression compression, const Metadata& metadata, Imf::PixelType type) {
    Imf::Header header(width, height, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                       imf_compression(compression));
    std::set<std::string> names;
    for (const std::string& channel : channels) {
        validate_name("channel name", channel);
        if (!names.insert(channel).second)
            throw InvalidInput("channel name '" + channel + "' is repeated");
        header.channels().insert(channel, Imf::Channel(type));
    }
    // The attributes that every file has, and those that OpenEXR reads in files of several parts.
    static const std::set<std::string> reserved = {"name",  "type", "version",  "chunkCount",
                                                   "tiles", "view", "multiView"};
    for (const auto& [key, value] : metadata) {
        validate_name("metadata key", key);
        if (reserved.contains(key) || header.find(key) != header.end())
            throw InvalidInput("metadata key '" + key +
                               "' is one of OpenEXR's own: choose another");
        header.insert(key, Imf::StringAttribute(value));
    }
    return header;
}

void require_known_convention(const std::string& path, const Imf::Header& header) {
    const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(convention_key);
    if (!attribute) return;
    const std::string& text = attribute->value();
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || number < 1)
        fail(path, std::string(convention_key) + " '" + text + "' is not a whole number from 1");
    if (number > convention)
        fail(path, "was written with convention " + std::to_string(number) +
                       "; this version reads up to " + std::to_string(convention) +
                       ": update LTMD");
}

/// Opens the file and calls `use` with it; whatever OpenEXR throws becomes a FileError.
template <class Use>
auto with_input(const std::string& path, int threads, const Use& use) {
    std::error_code error;
    if (!fs::exists(utf8_path(path), error)) fail(path, "does not exist");
    if (fs::is_directory(utf8_path(path), error)) fail(path, "is a folder, not a file");
    errno = 0;
    if (!std::ifstream(utf8_path(path), std::ios::binary))
        fail(path, "cannot be opened (" + error_text(errno) + ")");
    try {
#ifdef LTMD_HAS_EXR_CONTEXT
        // Without a handler OpenEXR also prints what it throws.
        const Imf::ContextInitializer quiet = Imf::ContextInitializer().setErrorHandler(
            [](exr_const_context_t, exr_result_t, const char*) {});
        Imf::InputFile file(path.c_str(), quiet, threads);
#else
        Imf::InputFile file(path.c_str(), threads);
#endif
        require_known_convention(path, file.header());
        return use(file);
    } catch (const FileError&) {
        throw;
    } catch (const std::exception& exception) {
        fail(path, std::string("is no OpenEXR file, or is damaged or cut short (") +
                       exception.what() + "): write it again");
    }
}

std::array<int, 2> size_of(const Imf::Header& header) {
    const Imath::Box2i window = header.dataWindow();
    return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

template <class Number>
std::string number_text(Number number) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(std::numeric_limits<Number>::max_digits10);
    text << number;
    return text.str();
}

/// Round to nearest even at `bits` of the mantissa; what would overflow is cut off instead.
float rounded(float value, int bits) {
    const auto u = std::bit_cast<std::uint32_t>(value);
    constexpr std::uint32_t exponent = 0x7f800000u;
    if ((u & exponent) == exponent) return value;
    const int dropped = full_mantissa - bits;
    const std::uint32_t mask = (1u << dropped) - 1;
    const std::uint32_t up = (u + (mask >> 1) + ((u >> dropped) & 1)) & ~mask;
    return std::bit_cast<float>((up & exponent) == exponent ? u & ~mask : up);
}

Imath::half to_half(float value) {
    constexpr float largest = HALF_MAX;
    return Imath::half(std::isfinite(value) ? std::clamp(value, -largest, largest) : value);
}

/// Which channels the pixels of a row have; the last one of `names` may be left out.
struct Layout {
    std::span<const std::string> names;
    std::size_t width, channels;

    std::size_t row() const { return width * channels; }
};

/// `ones`: a row of the channel that is left out.
template <class Item>
void insert_slices(Imf::FrameBuffer& buffer, Imf::PixelType type, const Item* pixels,
                   const Layout& layout, const std::vector<Item>& ones, int first_row) {
    const std::size_t stride = layout.row() * sizeof(Item);
    // OpenEXR's slices are not const, but writing only reads them; their base is row 0.
    for (std::size_t k = 0; k < layout.channels; ++k) {
        auto* first = reinterpret_cast<char*>(const_cast<Item*>(pixels + k)) -
                      static_cast<std::ptrdiff_t>(stride) * first_row;
        buffer.insert(layout.names[k],
                      Imf::Slice(type, first, layout.channels * sizeof(Item), stride));
    }
    if (layout.channels < layout.names.size())
        buffer.insert(layout.names.back(),
                      Imf::Slice(type, reinterpret_cast<char*>(const_cast<Item*>(ones.data())),
                                 sizeof(Item), 0));
}

/// Rows at a time, so that rounding needs little memory.
template <class Item, class Convert>
void write_converted(Imf::OutputFile& file, Imf::PixelType type, std::span<const float> pixels,
                     const Layout& layout, const Convert& convert) {
    constexpr int rows_at_a_time = 256;
    const std::size_t row = layout.row();
    const std::vector<Item> ones(layout.width, Item(1.0f));
    const int height = static_cast<int>(pixels.size() / row);
    std::vector<Item> strip;
    for (int first = 0; first < height; first += rows_at_a_time) {
        const int rows = std::min(rows_at_a_time, height - first);
        const auto part = pixels.subspan(row * first, row * rows);
        strip.resize(part.size());
        parallel_for(part.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) strip[i] = convert(part[i]);
        });
        Imf::FrameBuffer buffer;
        insert_slices(buffer, type, strip.data(), layout, ones, first);
        file.setFrameBuffer(buffer);
        file.writePixels(rows);
    }
}

void write_rows(Imf::OutputFile& file, std::span<const float> pixels, const Layout& layout,
                const Precision& precision) {
    const int bits = precision.mantissa_bits;
    if (precision.half)
        write_converted<Imath::half>(file, Imf::HALF, pixels, layout,
                                     [&](float v) { return to_half(rounded(v, bits)); });
    else if (bits < full_mantissa)
        write_converted<float>(file, Imf::FLOAT, pixels, layout,
                               [&](float v) { return rounded(v, bits); });
    else {
        const std::vector<float> ones(layout.width, 1.0f);
        Imf::FrameBuffer buffer;
        insert_slices(buffer, Imf::FLOAT, pixels.data(), layout, ones, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(static_cast<int>(pixels.size() / layout.row()));
    }
}

}  // namespace

int significant_bits(const Precision& precision) {
    constexpr int half_mantissa = 10;
    return precision.half ? std::min(precision.mantissa_bits, half_mantissa)
                          : precision.mantissa_bits;
}

void validate(const Precision& precision) {
    if (precision.mantissa_bits < 1 || precision.mantissa_bits > full_mantissa)
        throw InvalidInput("mantissa_bits is " + std::to_string(precision.mantissa_bits) +
                           "; it must be 1 to " + std::to_string(full_mantissa));
}

void write_exr(const std::string& path, std::span<const float> pixels, int width, int height,
               std::span<const std::string> channels, Compression compression,
               const Metadata& metadata, const Precision& precision) {
    validate(precision);
    if (width < 1 || height < 1 || width > max_size || height > max_size)
        throw InvalidInput("picture size " + std::to_string(width) + " x " +
                           std::to_string(height) + " is outside 1 to " + std::to_string(max_size) +
                           " pixels a side");
    if (channels.empty()) throw InvalidInput("a picture needs at least one channel name");
    Layout layout{channels, static_cast<std::size_t>(width), channels.size()};
    const std::size_t texels = layout.width * static_cast<std::size_t>(height);
    if (channels.size() > 1 && pixels.size() == texels * (channels.size() - 1)) --layout.channels;
    if (pixels.size() != texels * layout.channels)
        throw InvalidInput(std::to_string(pixels.size()) + " pixel values; expected " +
                           std::to_string(height) + " x " + std::to_string(width) + " x " +
                           std::to_string(channels.size()));
    const Imf::PixelType type = precision.half ? Imf::HALF : Imf::FLOAT;
    const Imf::Header header = make_header(width, height, channels, compression, metadata, type);
    TemporaryFile temporary(path);
    try {
        FileStream stream(temporary, path);
        Imf::OutputFile file(stream, header, compression == Compression::none ? 0 : file_threads());
        write_rows(file, pixels, layout, precision);
    } catch (const std::exception& exception) {
        fail(path, std::string("could not be written (") + exception.what() + ")");
    }
    temporary.publish();
}

ExrImage read_exr(const std::string& path) {
    return with_input(path, file_threads(), [&](Imf::InputFile& file) {
        ExrImage image;
        const auto [width, height] = size_of(file.header());
        image.width = width;
        image.height = height;
        const Imf::ChannelList& channels = file.header().channels();
        for (const char* name : {"R", "G", "B", "A"})
            if (channels.findChannel(name)) image.channels.emplace_back(name);
        for (auto c = channels.begin(); c != channels.end(); ++c)
            if (std::find(image.channels.begin(), image.channels.end(), c.name()) ==
                image.channels.end())
                image.channels.emplace_back(c.name());

        const std::size_t count = image.channels.size();
        image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                            count);
        const Imath::Box2i window = file.header().dataWindow();
        Imf::FrameBuffer buffer;
        for (std::size_t k = 0; k < count; ++k)
            buffer.insert(
                image.channels[k],
                Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + k, window, count * sizeof(float),
                                 static_cast<std::size_t>(width) * count * sizeof(float)));
        file.setFrameBuffer(buffer);
        file.readPixels(window.min.y, window.max.y);
        return image;
    });
}

Metadata exr_metadata(const std::string& path) {
    return with_input(path, 0, [](const Imf::InputFile& file) {
        Metadata metadata;
        const Imf::Header& header = file.header();
        for (auto a = header.begin(); a != header.end(); ++a) {
            const Imf::Attribute& attribute = a.attribute();
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute))
                metadata[a.name()] = text->value();
            else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&attribute))
                metadata[a.name()] = number_text(integer->value());
            else if (const auto* single = dynamic_cast<const Imf::FloatAttribute*>(&attribute))
                metadata[a.name()] = number_text(single->value());
            else if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&attribute))
                metadata[a.name()] = number_text(number->value());
        }
        return metadata;
    });
}

std::array<int, 2> exr_size(const std::string& path) {
    return with_input(path, 0, [](const Imf::InputFile& file) { return size_of(file.header()); });
}

}  // namespace ltmd::inline v0
