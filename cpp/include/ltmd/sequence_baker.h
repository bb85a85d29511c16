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
#include "ltmd/lobe_parameters.h"
#include "ltmd/passes.h"
#include "ltmd/rest_state.h"
#include "ltmd/tension.h"
#include "ltmd/texel_coverage.h"

namespace ltmd::inline v0 {

struct SequenceOptions {
    std::vector<std::string> passes = {"tension"};  ///< What frame() may be asked for (passes.h).
    int margin = 16;
    Tile tile = {};
    Per per = Per::corner;  ///< corner, vertex or triangle (flat).
    Compression compression = Compression::zip;
    Metadata metadata = {};
    int in_flight = 2;  ///< Frames of pixels held at most, 1 to 16; the same number of files is
                        ///< compressed at a time.
    Precision precision = {};  ///< Of the pixels in the files.
    Lobe lobe = {};            ///< Of the passes alpha2 and roughness.
};

/// Bakes the frames of an animation: coverage is computed once, each frame is a gather, and
/// compressing and writing one frame overlap with the next. Files are RGBA; A = 1 but in the pass
/// roughness. Their metadata is the options', the frame's, and always `ltmd:convention`,
/// `ltmd:pass`, `ltmd:per`, `ltmd:version`, in a UDIM tile `ltmd:udim`, below full precision
/// `ltmd:mantissa_bits`, and of a pass with a lobe `ltmd:alpha` ("x y"), `ltmd:m0` ("xx xy yx yy"),
/// `ltmd:strength` and `ltmd:height_response`. Texels that no triangle reaches hold the pass of the
/// identity.
///
/// cancel() and the counters may be called from any thread while another is in frame() or finish().
class LTMD_API SequenceBaker {
public:
    /// Throws InvalidInput for an unknown, repeated or missing pass, a bad size, margin,
    /// in_flight, precision or lobe, or a mesh that is not that of `rest`. `rest` must outlive the
    /// baker; `mesh` may be freed.
    SequenceBaker(const MeshView& mesh, const RestState& rest, int width, int height,
                  const SequenceOptions& options = {});
    /// Cancels what has not been written and waits for the files being written.
    ~SequenceBaker();

    /// Measures `deformed` ([V]) and queues one file for each pass in `paths` (pass -> path);
    /// blocks while in_flight frames are unwritten. Throws InvalidInput, the first writer's error,
    /// or Cancelled; then nothing of this frame is written.
    void frame(std::span<const Vec3f> deformed, const std::map<std::string, std::string>& paths,
               const Metadata& metadata = {});

    /// As above with another rest state of the same mesh, such as one in another metric; it need
    /// not outlive the call. Throws InvalidInput for one of another mesh size.
    void frame(const RestState& rest, std::span<const Vec3f> deformed,
               const std::map<std::string, std::string>& paths, const Metadata& metadata = {});

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
