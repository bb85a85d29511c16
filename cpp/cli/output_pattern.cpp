// SPDX-License-Identifier: Apache-2.0
#include "output_pattern.h"

#include <algorithm>
#include <set>

#include "errors.h"
#include "frame_numbers.h"

namespace ltmd::cli {
namespace {

constexpr const char *pass_mark = "<pass>", *udim_mark = "<UDIM>", *frame_mark = "<frame>";

bool contains(const std::string& text, const char* mark) {
    return text.find(mark) != std::string::npos;
}

void replace(std::string& text, const std::string& mark, const std::string& value) {
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += value.size())
        text.replace(at, mark.size(), value);
}

}  // namespace

OutputPattern::OutputPattern(std::vector<std::string> texts, std::vector<std::string> passes)
    : texts_(std::move(texts)), passes_(std::move(passes)) {
    if (texts_.size() == 1) texts_.resize(passes_.size(), texts_.front());
    if (texts_.size() != passes_.size())
        throw UsageError("there are " + std::to_string(texts_.size()) + " outputs (-o) for " +
                         std::to_string(passes_.size()) +
                         " passes; give one with <pass>, or one for each pass");
    std::set<std::string> seen;
    for (const std::string& pass : passes_)
        if (!seen.insert(path({pass, 0, 0})).second)
            throw UsageError("several passes would be written to one file; put <pass> into -o");
    const auto differ = [&](const char* mark) {
        return std::any_of(texts_.begin(), texts_.end(), [&](const std::string& text) {
            return contains(text, mark) != contains(texts_.front(), mark);
        });
    };
    if (differ(udim_mark) || differ(frame_mark))
        throw UsageError("every output (-o) needs the same of <UDIM> and <frame>");
}

bool OutputPattern::has_frame() const { return contains(texts_.front(), frame_mark); }

bool OutputPattern::has_udim() const { return contains(texts_.front(), udim_mark); }

std::string OutputPattern::path(const OutputName& name) const {
    const auto pass = std::find(passes_.begin(), passes_.end(), name.pass) - passes_.begin();
    std::string path = texts_[static_cast<std::size_t>(pass)];
    replace(path, pass_mark, name.pass);
    replace(path, udim_mark, std::to_string(name.udim));
    if (name.frame) replace(path, frame_mark, frame_digits(*name.frame));
    return path;
}

}  // namespace ltmd::cli
