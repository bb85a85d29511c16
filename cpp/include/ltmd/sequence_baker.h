// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ltmd/exr.h"
#include "ltmd/export.h"
#include "ltmd/rest_state.h"
#include "ltmd/tension.h"
#include "ltmd/texel_coverage.h"

namespace ltmd::inline v0 {

/// Names of what can be baked from tension: "tension" (t11, t12, t22) and "stretch".
LTMD_API std::span<const std::string> pass_names();

struct SequenceOptions {
    std::vector<std::string> passes = {"tension"};
    int margin = 16;
    Tile tile = {};
    Per per = Per::corner;  ///< corner, vertex or triangle (flat).
    Compression compression = Compression::zip;
    Metadata metadata = {};
    int in_flight = 2;  ///< Frames of pixels held at most, 1 to 16.
};

/// Bakes the frames of an animation: coverage is computed once, each frame is a gather, and compressing and writing one
/// frame overlap with the next. Files are RGBA, 32-bit float, A = 1, with `ltmd:convention`, `ltmd:pass` and `ltmd:per` in the header.
class LTMD_API SequenceBaker {
public:
    /// Throws InvalidInput for an unknown pass or a bad size. `rest` must outlive the baker; `mesh` may be freed.
    SequenceBaker(const MeshView& mesh, const RestState& rest, int width, int height, const SequenceOptions& options = {});
    /// Cancels what has not been written.
    ~SequenceBaker();

    /// Measures `deformed` ([V]) and queues one file per pass of `paths`; blocks while in_flight frames are unwritten. `metadata` is added to the options'.
    /// Throws InvalidInput, a writer's earlier FileError, or Cancelled.
    void frame(std::span<const Vec3f> deformed, const std::map<std::string, std::string>& paths, const Metadata& metadata = {});

    /// Drops queued files; complete files stay, none is left half-written.
    void cancel();

    /// Waits until every file is written; throws the first writer's FileError. After it, or after cancel(), frame() throws.
    void finish();

    std::size_t files_submitted() const;
    std::size_t files_written() const;
    const TexelCoverage& coverage() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ltmd::inline v0
