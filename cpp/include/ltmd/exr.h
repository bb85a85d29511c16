// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "ltmd/export.h"

/// Float OpenEXR files with metadata.
///
/// Keys of this project start with `ltmd:`; `ltmd:convention` is the version of what the numbers
/// mean. Paths are UTF-8.
namespace ltmd::inline v0 {

/// The highest `ltmd:convention` that this library reads, and the one it writes.
inline constexpr int convention = 1;

enum class Compression {
    none,
    zips,  ///< zip of single rows.
    zip,   ///< zip of 16 rows.
    piz,   ///< Wavelets of 32 rows.
};

inline constexpr int full_mantissa = 23;

/// How precisely pixels are stored.
struct Precision {
    bool half = false;  ///< 16-bit float: 10 mantissa bits, range 6e-5 to 65504 at that precision.
    int mantissa_bits = full_mantissa;  ///< Rounded to nearest even at 1 to 23 bits (a relative
                                        ///< error up to 2^-(bits+1)): zeros compress well.
};

/// The mantissa bits that a precision keeps.
LTMD_API int significant_bits(const Precision& precision);

/// Throws InvalidInput for mantissa_bits outside 1 to 23.
LTMD_API void validate(const Precision& precision);

using Metadata = std::map<std::string, std::string>;

struct ExrImage {
    int width = 0, height = 0;
    std::vector<std::string> channels;  ///< R, G, B, A first where present, then the file's order.
    std::vector<float> pixels;          ///< [height * width * channels], row 0 = top.
};

/// Writes `pixels` ([height * width * channels.size()], row 0 = top), at full precision as they
/// are. Where the pixels have one channel fewer than are named, the last one is 1: a finite alpha.
/// Rounding keeps finite values finite (the largest number stands for what exceeds it) and the
/// others as they are. The file appears at `path` only when it is complete: it is
/// written beside it under a temporary name (`.ltmd-*.tmp`) and renamed. Throws FileError (the old
/// file, if any, is unharmed and the temporary one removed) and InvalidInput (sizes outside 1 to
/// 65536, no or repeated channel names, metadata keys that are empty or that OpenEXR uses itself,
/// precision).
LTMD_API void write_exr(const std::string& path, std::span<const float> pixels, int width,
                        int height, std::span<const std::string> channels,
                        Compression compression = Compression::zip, const Metadata& metadata = {},
                        const Precision& precision = {});

/// Reads all channels as 32-bit float. Throws FileError for a file that is missing, damaged or
/// incomplete, and for an `ltmd:convention` above ours.
LTMD_API ExrImage read_exr(const std::string& path);

/// The string attributes of a file's header; numbers as text. Throws as read_exr.
LTMD_API Metadata exr_metadata(const std::string& path);

/// Width and height from the header alone. Throws as read_exr.
LTMD_API std::array<int, 2> exr_size(const std::string& path);

}  // namespace ltmd::inline v0
