// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ltmd/export.h"

namespace ltmd::inline v0 {

struct VerifyReport {
    std::vector<std::string> problems;                  ///< One sentence each, naming the file or frame.
    std::map<std::string, std::vector<int>> sequences;  ///< Sequence name (`object_pass` or `object_pass.udim`) -> its frames, sorted.
    bool ok() const { return problems.empty(); }
};

/// Checks every baked sequence in a folder: each frame present (a missing one would render as the identity), one size per sequence, all
/// values finite, tension's diagonal in [1e-3, 1e3], A = 1, one convention. The frames expected are `frames` if not empty, else the range that the
/// files' own metadata states (`ltmd:frame_start`, `ltmd:frame_end`), else lowest to highest. Files without `ltmd:convention` are not ours and ignored,
/// unless unreadable. Throws FileError when the folder cannot be read; a folder without sequences is a problem, not an error.
LTMD_API VerifyReport verify(const std::string& directory, const std::vector<int>& frames = {});

}  // namespace ltmd::inline v0
