// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace ltmd::cli {

/// What the placeholders of a path stand for in one file.
struct OutputName {
    std::string pass;
    int udim;
    std::optional<int> frame;
};

/// `-o` texts: one for all passes, or one for each pass in their order. `<pass>`, `<UDIM>` and
/// `<frame>` are replaced in each file's path.
class OutputPattern {
public:
    /// Throws UsageError when the counts do not fit, or several passes would share a path.
    OutputPattern(std::vector<std::string> texts, std::vector<std::string> passes);

    bool has_frame() const;
    bool has_udim() const;

    std::string path(const OutputName& name) const;

private:
    std::vector<std::string> texts_, passes_;
};

}  // namespace ltmd::cli
