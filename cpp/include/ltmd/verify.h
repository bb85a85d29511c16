// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ltmd/export.h"

namespace ltmd::inline v0 {

struct VerifyReport {
    std::vector<std::string>
        problems;  ///< One sentence each, naming the file or the sequence and frames.
    std::map<std::string, std::vector<int>>
        sequences;  ///< Sequence name (`object_pass` or `object_pass.udim`) -> its frames, sorted.
    bool ok() const { return problems.empty(); }
};

/// Checks every baked sequence in a folder: files named `<sequence>.<frame>.exr` (a frame of 4 to 9
/// characters: 0007, or -007 before 0) with `ltmd:convention`. Others are not ours and ignored,
/// unless they have such a name and are unreadable.
///
/// A still of a UDIM tile, `<name>.<udim>.exr` without `ltmd:frame`, is frame 0 of a sequence of
/// its own, `<name>.<udim>`.
///
/// Each frame is present (a missing one would render as the identity) and once, has the number that
/// its header states, and can be read whole; all frames of a sequence have one size and one
/// convention, pass, `ltmd:per`, UV map, rest state and lobe; all values are finite and possible
/// for their pass (stretches in [1e-3, 1e3], positive alphas), within the rounding that the file
/// states, and A = 1 but in the pass roughness. The frames expected, and the only ones looked at,
/// are `frames` if not empty, else the range that the files' own metadata states
/// (`ltmd:frame_start`, `ltmd:frame_end`), else lowest to highest. `sequences`, if not empty, are
/// the only ones looked at, and one without a file is a problem. Throws FileError when the folder
/// cannot be read; a folder without sequences is a problem, not an error.
LTMD_API VerifyReport verify(const std::string& directory, const std::vector<int>& frames = {},
                             const std::vector<std::string>& sequences = {});

}  // namespace ltmd::inline v0
