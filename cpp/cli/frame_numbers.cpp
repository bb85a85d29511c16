// SPDX-License-Identifier: Apache-2.0
#include "frame_numbers.h"

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "errors.h"

namespace ltmd::cli {
namespace {

constexpr int most_frames = 1'000'000;

std::optional<int> number(const std::string& text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    return value;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
    static const std::regex part_pattern(R"((-?\d+)(?:-(-?\d+)(?:x(\d+))?)?)");
    const UsageError refused("frames are written 7, 1-24, 1-10,20 or 1-24x2, not '" + text + "'");
    std::vector<int> frames;
    std::set<int> seen;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        std::smatch match;
        if (!std::regex_match(part, match, part_pattern)) throw refused;
        const std::optional<int> first = number(match[1]),
                                 last = match[2].matched ? number(match[2]) : first,
                                 step = match[3].matched ? number(match[3]) : 1;
        if (!first || !last || !step || *step < 1 || *last < *first) throw refused;
        for (std::int64_t frame = *first; frame <= *last; frame += *step) {
            if (frames.size() == most_frames) throw UsageError("too many frames: '" + text + "'");
            if (!seen.insert(static_cast<int>(frame)).second)
                throw UsageError("frame " + std::to_string(frame) + " is given twice in '" + text +
                                 "'");
            frames.push_back(static_cast<int>(frame));
        }
    }
    if (frames.empty() && !text.empty()) throw refused;
    return frames;
}

std::vector<int> frames_of_files(const std::vector<std::string>& paths) {
    std::vector<int> frames;
    std::map<int, std::string> seen;
    for (const std::string& path : paths) {
        const std::string stem = std::filesystem::path(path).stem().string();
        const std::size_t last = stem.find_last_of("0123456789");
        if (last == std::string::npos)
            throw UsageError(path + ": its name has no frame number; say --frames");
        const std::size_t before = stem.find_last_not_of("0123456789", last);
        const std::size_t first = before == std::string::npos ? 0 : before + 1;
        const std::optional<int> frame = number(stem.substr(first, last - first + 1));
        if (!frame) throw UsageError(path + ": its frame number is too large; say --frames");
        const auto [other, is_new] = seen.emplace(*frame, path);
        if (!is_new)
            throw UsageError(path + " and " + other->second + " are both frame " +
                             std::to_string(*frame) + "; say --frames");
        frames.push_back(*frame);
    }
    return frames;
}

std::string frame_digits(int frame) {
    char text[16];
    std::snprintf(text, sizeof text, "%04d", frame);
    return text;
}

}  // namespace ltmd::cli
