// SPDX-License-Identifier: Apache-2.0
#include "ltmd/verify.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>
#include <system_error>

#include "ltmd/errors.h"
#include "ltmd/exr.h"
#include "ltmd/passes.h"
#include "parallel.h"
#include "utf8_path.h"

namespace ltmd::inline v0 {
namespace {

namespace fs = std::filesystem;

constexpr float smallest_stretch = 1e-3f, largest_stretch = 1e3f, rounding = 1e-5f;

/// A file of a sequence.
struct File {
    std::string name;  ///< Within the folder.
    std::optional<Metadata> metadata;
    std::array<int, 2> size{};
};

/// Frame -> file.
using Sequence = std::map<int, File>;

std::optional<int> whole_number(const std::string& text) {
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    return number;
}

struct FrameName {
    std::string sequence;
    int frame;
};

/// `balloon_tension.1001.0007.exr` -> balloon_tension.1001, 7. Frames before 0 are written as -007.
std::optional<FrameName> parse(const std::string& name) {
    constexpr std::string_view extension = ".exr";
    if (!name.ends_with(extension)) return {};
    const std::string stem = name.substr(0, name.size() - extension.size());
    const std::size_t dot = stem.rfind('.');
    if (dot == std::string::npos || dot == 0) return {};
    const std::string digits = stem.substr(dot + 1);
    if (digits.size() < 4 || digits.size() > 9) return {};
    const std::optional<int> frame = whole_number(digits);
    if (!frame) return {};
    return FrameName{stem.substr(0, dot), *frame};
}

std::string frame_text(int frame) { return "frame " + std::to_string(frame); }

std::string size_text(std::array<int, 2> size) {
    return std::to_string(size[0]) + " x " + std::to_string(size[1]);
}

class Check {
public:
    Check(const std::string& directory, const std::vector<std::string>& only)
        : directory_(directory), only_(only.begin(), only.end()) {
        const fs::path folder = utf8_path(directory);
        std::error_code error;
        if (!fs::is_directory(folder, error))
            throw FileError(
                directory + ": " +
                (fs::exists(folder, error) ? "is a file, not a folder" : "does not exist"));
        std::set<std::string> names;
        fs::directory_iterator entry(folder, error);
        for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
            std::error_code ignored;
            if (!entry->is_directory(ignored)) names.insert(utf8_text(entry->path().filename()));
        }
        if (error) throw FileError(directory + ": cannot be read (" + error.message() + ")");
        for (const std::string& name : names) add(name);
    }

    VerifyReport run(const std::vector<int>& frames) {
        const std::set<int> expected(frames.begin(), frames.end());
        for (auto& [name, sequence] : sequences_) {
            // A broken file alone may be anyone's.
            if (std::none_of(sequence.begin(), sequence.end(),
                             [](const auto& f) { return f.second.metadata.has_value(); }))
                continue;
            if (!expected.empty())
                std::erase_if(sequence, [&](const auto& f) { return !expected.contains(f.first); });
            std::vector<int>& found = report_.sequences[name];
            for (const auto& [frame, file] : sequence) found.push_back(frame);
            check_frames(name, sequence, expected);
            check_alike(name, sequence);
            for (const auto& [frame, file] : sequence) check_file(name, frame, file);
        }
        if (report_.sequences.empty() && only_.empty())
            problem(directory_, "holds no baked sequence (files such as balloon_tension.0001.exr)");
        for (const std::string& name : only_)
            if (!report_.sequences.contains(name)) problem(name, "has no file: bake it");
        return std::move(report_);
    }

private:
    void problem(const std::string& subject, const std::string& sentence) {
        report_.problems.push_back(subject + ": " + sentence);
    }

    std::string path(const std::string& name) const {
        return utf8_text(utf8_path(directory_) / utf8_path(name));
    }

    void add(const std::string& name) {
        const std::optional<FrameName> parsed = parse(name);
        if (!parsed || (!only_.empty() && !only_.contains(parsed->sequence))) return;
        File file{name, {}, {}};
        try {
            file.metadata = exr_metadata(path(name));
            if (!file.metadata->contains("ltmd:convention")) return;
            file.size = exr_size(path(name));
        } catch (const FileError& error) {
            file.metadata.reset();
            report_.problems.push_back(error.what());
        }
        // A still of a UDIM tile, face_tension.1001.exr, is a sequence of its own with one frame.
        std::string sequence = parsed->sequence;
        int frame = parsed->frame;
        if (stated(file, "ltmd:udim") == frame && !stated(file, "ltmd:frame")) {
            sequence += "." + std::to_string(frame);
            frame = 0;
        }
        const auto [found, is_new] = sequences_[sequence].emplace(frame, std::move(file));
        if (!is_new)
            problem(sequence, frame_text(frame) + " has two files, " + found->second.name +
                                  " and " + name + ": delete one");
    }

    /// Names the missing ones of `expected` frames, runs of neighbours together.
    void check_frames(const std::string& name, const Sequence& sequence,
                      const std::set<int>& expected) {
        std::vector<std::pair<int, int>> missing;  // first and last of each run
        if (!expected.empty()) {
            bool in_run = false;
            for (const int frame : expected) {
                const bool absent = !sequence.contains(frame);
                if (absent && in_run && missing.back().second == frame - 1)
                    missing.back().second = frame;
                else if (absent)
                    missing.emplace_back(frame, frame);
                in_run = absent;
            }
        } else {
            std::int64_t first = sequence.begin()->first, last = sequence.rbegin()->first;
            for (const auto& [frame, file] : sequence) {
                first =
                    std::min<std::int64_t>(first, stated(file, "ltmd:frame_start").value_or(frame));
                last = std::max<std::int64_t>(last, stated(file, "ltmd:frame_end").value_or(frame));
            }
            std::int64_t next = first;
            const auto gap_until = [&](std::int64_t frame) {
                if (next < frame)
                    missing.emplace_back(static_cast<int>(next), static_cast<int>(frame - 1));
                next = frame + 1;
            };
            for (const auto& [frame, file] : sequence) gap_until(frame);
            gap_until(last + 1);
        }
        for (const auto& [first, last] : missing)
            if (first == last)
                problem(name, frame_text(first) +
                                  " is missing (it would render as undeformed): bake it again");
            else
                problem(name,
                        "frames " + std::to_string(first) + " to " + std::to_string(last) +
                            " are missing (they would render as undeformed): bake them again");
    }

    static std::optional<int> stated(const File& file, const std::string& key) {
        if (!file.metadata) return {};
        const auto found = file.metadata->find(key);
        return found == file.metadata->end() ? std::nullopt : whole_number(found->second);
    }

    /// Each frame against the first that can be read.
    void check_alike(const std::string& name, const Sequence& sequence) {
        const auto first = std::find_if(sequence.begin(), sequence.end(), [](const auto& f) {
            return f.second.metadata.has_value();
        });
        if (first == sequence.end()) return;
        for (auto it = std::next(first); it != sequence.end(); ++it) {
            const auto& [frame, file] = *it;
            if (!file.metadata) continue;
            if (file.size != first->second.size)
                problem(name, frame_text(frame) + " is " + size_text(file.size) + ", " +
                                  frame_text(first->first) + " is " +
                                  size_text(first->second.size) + ": bake one of them again");
            for (const char* key :
                 {"ltmd:convention", "ltmd:pass", "ltmd:per", "ltmd:uv_map", "ltmd:rest",
                  "ltmd:alpha", "ltmd:m0", "ltmd:strength", "ltmd:height_response"}) {
                const std::string mine = value(file, key), others = value(first->second, key);
                if (mine != others)
                    problem(name, frame_text(frame) + " has " + key + " '" + mine + "', " +
                                      frame_text(first->first) + " has '" + others +
                                      "': bake one of them again");
            }
        }
    }

    static std::string value(const File& file, const std::string& key) {
        const auto found = file.metadata->find(key);
        return found == file.metadata->end() ? std::string() : found->second;
    }

    void check_file(const std::string& name, int frame, const File& file) {
        if (!file.metadata) return;  // already a problem
        const std::optional<int> header_frame = stated(file, "ltmd:frame");
        if (header_frame && *header_frame != frame)
            problem(name, frame_text(frame) + " says in its header that it is " +
                              frame_text(*header_frame) +
                              ": it was renamed, or copied over another; bake it again");
        try {
            const int bits = stated(file, "ltmd:mantissa_bits").value_or(full_mantissa);
            check_pixels(name, frame, read_exr(path(file.name)), value(file, "ltmd:pass"),
                         rounding + std::ldexp(1.0f, -bits));
        } catch (const FileError& error) {
            report_.problems.push_back(error.what());
        }
    }

    /// `slack`: the relative error of stored values.
    void check_pixels(const std::string& name, int frame, const ExrImage& image, std::string pass,
                      float slack) {
        const std::size_t count = image.channels.size();
        const auto channel = [&](const char* channel_name) {
            const auto found =
                std::find(image.channels.begin(), image.channels.end(), channel_name);
            return static_cast<std::size_t>(found - image.channels.begin());
        };
        const std::size_t red = channel("R"), green = channel("G"), blue = channel("B"),
                          alpha = channel("A");
        if (alpha == count)
            problem(name, frame_text(frame) + " has no channel A: Blender needs it; bake it again");
        const auto all = pass_names();
        const bool is_known = std::find(all.begin(), all.end(), pass) != all.end();
        if (is_known && (red == count || green == count || blue == count)) {
            problem(name, frame_text(frame) + " has no channels R, G, B, so it holds no " + pass +
                              ": bake it again");
            pass.clear();
        }
        const auto report = [&](const std::string& what, const auto& is_bad) {
            report_first(name, frame, image, what, is_bad);
        };
        report("a value that is not finite", [&](const float* p) {
            return std::any_of(p, p + count, [](float v) { return !std::isfinite(v); });
        });
        const float more = 1 + slack, low = smallest_stretch * (1 - slack),
                    high = largest_stretch * (1 + slack);
        const auto outside = [=](float v) { return v < low || v > high; };
        if (pass == "tension")
            report("a tension with a diagonal outside 0.001 to 1000",
                   [&](const float* p) { return outside(p[red]) || outside(p[blue]); });
        else if (pass == "stretch")
            report("stretches that are not positive, the larger first", [&](const float* p) {
                return p[green] <= 0 || p[blue] <= 0 || p[red] > high || p[green] > p[red] * more;
            });
        else if (pass == "wrinkle")
            report("a stretch outside 0.001 to 1000 or a shear beyond a right angle",
                   [&](const float* p) {
                       return outside(p[red]) || outside(p[green]) ||
                              std::abs(p[blue]) > std::numbers::pi_v<float> / 2 * more;
                   });
        else if (pass == "alpha2")
            report("an alpha^2 matrix that is not positive", [&](const float* p) {
                return p[red] <= 0 || p[blue] <= 0 ||
                       std::abs(double{p[green]}) > std::sqrt(double{p[red]} * p[blue]) * more;
            });
        else if (pass == "roughness")
            report("alphas that are not positive, the smaller first, or a direction beyond 1",
                   [&](const float* p) {
                       const float sine = alpha < count ? p[alpha] : 0;
                       return p[red] <= 0 || p[red] > p[green] || std::hypot(p[blue], sine) > more;
                   });
        if (alpha < count && pass != "roughness")
            report("an alpha other than 1",
                   [&](const float* p) { return std::isfinite(p[alpha]) && p[alpha] != 1; });
    }

    /// One problem for all pixels that `is_bad`, with the first one's place.
    void report_first(const std::string& name, int frame, const ExrImage& image,
                      const std::string& what, const std::function<bool(const float*)>& is_bad) {
        const auto width = static_cast<std::size_t>(image.width);
        const std::size_t count = image.channels.size(),
                          pixels = width * static_cast<std::size_t>(image.height);
        std::size_t first = std::numeric_limits<std::size_t>::max(), bad = 0;
        std::mutex mutex;
        parallel_for(pixels, 1 << 16, [&](std::size_t begin, std::size_t end) {
            std::size_t piece_first = std::numeric_limits<std::size_t>::max(), piece_bad = 0;
            for (std::size_t i = begin; i < end; ++i)
                if (is_bad(image.pixels.data() + i * count)) {
                    piece_first = std::min(piece_first, i);
                    ++piece_bad;
                }
            const std::lock_guard lock(mutex);
            first = std::min(first, piece_first);
            bad += piece_bad;
        });
        if (bad == 0) return;
        problem(name, frame_text(frame) + " has " + what + " in " + std::to_string(bad) +
                          (bad == 1 ? " pixel" : " pixels") + ", first at column " +
                          std::to_string(first % width) + ", row " + std::to_string(first / width) +
                          ": bake it again");
    }

    std::string directory_;
    std::set<std::string> only_;
    std::map<std::string, Sequence> sequences_;
    VerifyReport report_;
};

}  // namespace

VerifyReport verify(const std::string& directory, const std::vector<int>& frames,
                    const std::vector<std::string>& sequences) {
    return Check(directory, sequences).run(frames);
}

}  // namespace ltmd::inline v0
