// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace ltmd::cli {

/// `7`, `1-24`, `1-10,20`, `1-24x2` or an empty text (no frames), in the order given. Throws
/// UsageError for anything else, repeats, or more than a million.
std::vector<int> parse_frames(const std::string& text);

/// The last digits in each file's name before its extension: face.0012.obj is frame 12. Throws
/// UsageError when a file has none or two files have the same.
std::vector<int> frames_of_files(const std::vector<std::string>& paths);

/// At least four characters, as Blender numbers files: 0007, -007.
std::string frame_digits(int frame);

}  // namespace ltmd::cli
