// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ltmd/export.h"
#include "ltmd/exr.h"
#include "ltmd/rest_state.h"
#include "ltmd/tension.h"
#include "ltmd/texel_coverage.h"

namespace ltmd::inline v0 {

/// Names of what can be baked from tension: "tension" (t11, t12, t22) and "stretch".
LTMD_API std::span<const std::string> pass_names();

struct SequenceOptions {
    std::vector<std::string> passes = {"tension"};  ///< What frame() may be asked for.
    int margin = 16;
    Tile tile = {};
    Per per = Per::corner;  ///< corner, vertex or triangle (flat).
    Compression compression = Compression::zip;
    Metadata metadata = {};
    int in_flight = 2;  ///< Frames of pixels held at most, 1 to 16; the same number of files is
                        ///< compressed at a time.
};

/// Bakes the frames of an animation: coverage is computed once, each frame is a gather, and
/// compressing and writing one frame overlap with the next. Files are RGBA, 32-bit float, A = 1.
/// Their metadata is the options', the frame's, and always `ltmd:convention`, `ltmd:pass`,
/// `ltmd:per`, `ltmd:version` and, in a UDIM tile, `ltmd:udim`. Texels that no triangle reaches
/// hold the pass of the identity.
///
/// cancel() and the counters may be called from any thread while another is in frame() or finish().
class LTMD_API SequenceBaker {
public:
    /// Throws InvalidInput for an unknown, repeated or missing pass, a bad size, margin or
    /// in_flight, or a mesh that is not that of `rest`. `rest` must outlive the baker; `mesh` may
    /// be freed.
    SequenceBaker(const MeshView& mesh, const RestState& rest, int width, int height,
                  const SequenceOptions& options = {});
    /// Cancels what has not been written and waits for the files being written.
    ~SequenceBaker();

    /// Measures `deformed` ([V]) and queues one file for each pass in `paths` (pass -> path);
    /// blocks while in_flight frames are unwritten. Throws InvalidInput, the first writer's error,
    /// or Cancelled; then nothing of this frame is written.
    void frame(std::span<const Vec3f> deformed, const std::map<std::string, std::string>& paths,
               const Metadata& metadata = {});

    /// Drops queued files; complete files stay, none is left half-written. Does not wait for the
    /// files being written.
    void cancel();

    /// Waits until every file is written; throws the first writer's error (files queued after it
    /// were dropped), or Cancelled. After it, frame() throws InvalidInput.
    void finish();

    std::size_t files_submitted() const;
    std::size_t files_written() const;
    const TexelCoverage& coverage() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ltmd::inline v0
