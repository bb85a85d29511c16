// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sequence_baker.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "ltmd/bake.h"
#include "ltmd/errors.h"
#include "ltmd/threads.h"
#include "ltmd/version.h"

namespace ltmd::inline v0 {
namespace {

constexpr int max_in_flight = 16;

const char* name_of(Per per) {
    switch (per) {
        case Per::triangle:
            return "triangle";
        case Per::vertex:
            return "vertex";
        case Per::corner:
            return "corner";
    }
    throw InvalidInput("unknown per");
}

std::string version_text() {
    return std::to_string(LTMD_VERSION_MAJOR) + "." + std::to_string(LTMD_VERSION_MINOR) + "." +
           std::to_string(LTMD_VERSION_PATCH);
}

std::string text(std::initializer_list<double> numbers) {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(17);
    const char* gap = "";
    for (const double number : numbers) {
        stream << gap << number;
        gap = " ";
    }
    return stream.str();
}

Metadata lobe_metadata(const Lobe& lobe) {
    return {{"ltmd:alpha", text({lobe.alpha_x, lobe.alpha_y})},
            {"ltmd:m0", text({lobe.m0.xx, lobe.m0.xy, lobe.m0.yx, lobe.m0.yy})},
            {"ltmd:strength", text({lobe.strength})},
            {"ltmd:height_response", text({lobe.height_response})}};
}

void require_count(const char* what, std::size_t mesh, std::size_t rest) {
    if (mesh != rest)
        throw InvalidInput("the mesh has " + std::to_string(mesh) + " " + what +
                           ", its rest state " + std::to_string(rest));
}

void require_rest_of(std::size_t triangles, std::size_t corners, std::size_t vertices,
                     const RestState& rest) {
    require_count("triangles", triangles, rest.triangle_count());
    require_count("corners", corners, rest.corner_count());
    require_count("vertices", vertices, rest.vertex_count());
}

const SequenceOptions& validated(const SequenceOptions& options, const MeshView& mesh,
                                 const RestState& rest) {
    require_rest_of(mesh.triangles.size(), mesh.corner_vert.size(),
                    static_cast<std::size_t>(std::max(0, mesh.vertex_count)), rest);
    std::set<std::string> seen;
    for (const std::string& pass : options.passes) {
        pass_channels(pass);  // throws for an unknown one
        if (!seen.insert(pass).second) throw InvalidInput("pass '" + pass + "' is repeated");
    }
    if (options.passes.empty()) throw InvalidInput("no pass to bake");
    if (options.in_flight < 1 || options.in_flight > max_in_flight)
        throw InvalidInput("in_flight " + std::to_string(options.in_flight) + " is outside 1 to " +
                           std::to_string(max_in_flight) + " frames");
    validate(options.precision);
    validate(options.lobe);
    return options;
}

}  // namespace

struct SequenceBaker::State {
    /// The pixels of one frame, one picture per pass; kept for the next frame.
    struct Frame {
        std::map<std::string, std::vector<float>> pixels;
        std::size_t unwritten = 0;
    };
    struct File {
        Frame* frame;
        std::string pass, path;
        Metadata metadata;
    };

    State(const MeshView& mesh, const RestState& rest_state, int width, int height,
          const SequenceOptions& sequence_options)
        : options(validated(sequence_options, mesh, rest_state)),
          rest(rest_state),
          coverage(mesh, width, height, options.tile, options.margin) {
        if (options.per == Per::vertex)
            corner_vert.assign(mesh.corner_vert.begin(), mesh.corner_vert.end());
        options.metadata["ltmd:convention"] = std::to_string(convention);
        options.metadata["ltmd:per"] = name_of(options.per);
        options.metadata["ltmd:version"] = version_text();
        const int bits = significant_bits(options.precision);
        if (bits < full_mantissa) options.metadata["ltmd:mantissa_bits"] = std::to_string(bits);
        if (options.tile.u >= 0 && options.tile.u <= 9 && options.tile.v >= 0 &&
            options.tile.v <= 99)
            options.metadata["ltmd:udim"] = std::to_string(udim(options.tile));
        frames.resize(static_cast<std::size_t>(options.in_flight));
        for (Frame& frame : frames) free.push_back(&frame);
        const int writers = std::min(options.in_flight, thread_count());
        try {
            for (int i = 0; i < writers; ++i) threads.emplace_back([this] { write_files(); });
        } catch (...) {
            stop();
            throw;
        }
    }

    ~State() { stop(); }

    /// Cancels and joins.
    void stop() {
        cancel();
        {
            const std::lock_guard lock(mutex);
            stopping = true;
        }
        changed.notify_all();
        for (std::thread& thread : threads) thread.join();
        threads.clear();
    }

    void cancel() {
        {
            const std::lock_guard lock(mutex);
            cancelled = true;
            drop_queue();
        }
        changed.notify_all();
    }

    /// With the mutex held.
    void drop_queue() {
        for (const File& file : queue) release(*file.frame);
        queue.clear();
    }
    void release(Frame& frame) {
        if (--frame.unwritten == 0) free.push_back(&frame);
    }

    /// With the mutex held.
    void throw_if_over() const {
        if (error) std::rethrow_exception(error);
        if (cancelled) throw Cancelled("the bake was cancelled");
        if (finished)
            throw InvalidInput("the bake is finished: start another SequenceBaker for more frames");
    }

    void write_files() {
        std::unique_lock lock(mutex);
        for (;;) {
            changed.wait(lock, [this] { return stopping || !queue.empty(); });
            if (stopping) return;
            const File file = std::move(queue.front());
            queue.pop_front();
            ++writing;
            lock.unlock();
            std::exception_ptr problem;
            try {
                // Where the pass has three channels, write_exr() adds the alpha.
                static const std::vector<std::string> channels = {"R", "G", "B", "A"};
                write_exr(file.path, file.frame->pixels.at(file.pass), coverage.width(),
                          coverage.height(), channels, options.compression, file.metadata,
                          options.precision);
            } catch (...) {
                problem = std::current_exception();
            }
            lock.lock();
            --writing;
            if (!problem) ++written;
            release(*file.frame);
            if (problem && !error) {
                error = problem;
                drop_queue();
            }
            changed.notify_all();
        }
    }

    Frame& wait_for_frame() {
        std::unique_lock lock(mutex);
        changed.wait(lock, [this] { return error || cancelled || finished || !free.empty(); });
        throw_if_over();
        Frame& frame = *free.back();
        free.pop_back();
        frame.unwritten = 1;  // this call's own hold
        return frame;
    }

    void bake_pass(const std::string& pass, std::vector<float>& pixels) {
        const int channels = pass_channels(pass);
        compute_pass(pass, tensions, options.lobe, values);
        std::vector<float> background;
        compute_pass(pass, {&identity_tension, 1}, options.lobe, background);
        pixels.resize(coverage.texels().size() * static_cast<std::size_t>(channels));
        if (options.per == Per::triangle) {
            bake_flat(coverage, values, channels, background, channels, pixels);
            return;
        }
        if (options.per == Per::corner) {
            bake(coverage, values, channels, background, channels, pixels);
            return;
        }
        const auto count = static_cast<std::size_t>(channels);
        corners.resize(corner_vert.size() * count);
        for (std::size_t c = 0; c < corner_vert.size(); ++c)
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(corner_vert[c]) * channels,
                        channels, corners.begin() + static_cast<std::ptrdiff_t>(c * count));
        bake(coverage, corners, channels, background, channels, pixels);
    }

    void frame(const RestState& frame_rest, std::span<const Vec3f> deformed,
               const std::map<std::string, std::string>& paths, const Metadata& metadata) {
        const std::lock_guard one_frame_at_a_time(frame_mutex);
        require_rest_of(coverage.triangles().size(), coverage.corner_count(), rest.vertex_count(),
                        frame_rest);
        std::set<std::string> seen;
        for (const auto& [pass, path] : paths) {
            if (std::find(options.passes.begin(), options.passes.end(), pass) ==
                options.passes.end())
                throw InvalidInput("pass '" + pass + "' is not among the passes of this bake");
            if (!seen.insert(path).second) throw InvalidInput("two passes have the path " + path);
        }
        if (paths.empty()) throw InvalidInput("a frame needs the path of at least one pass");

        Frame& frame = wait_for_frame();
        try {
            tensions.resize(tension_count(frame_rest, options.per));
            tension(frame_rest, deformed, options.per, tensions);
            for (const auto& [pass, path] : paths) bake_pass(pass, frame.pixels[pass]);

            std::deque<File> files;
            for (const auto& [pass, path] : paths) {
                Metadata merged = options.metadata;
                for (const auto& [key, value] : metadata) merged[key] = value;
                for (const char* key : {"ltmd:convention", "ltmd:per", "ltmd:version", "ltmd:udim",
                                        "ltmd:mantissa_bits"})
                    if (const auto ours = options.metadata.find(key);
                        ours != options.metadata.end())
                        merged[key] = ours->second;
                merged["ltmd:pass"] = pass;
                if (pass_uses_lobe(pass))
                    for (const auto& [key, value] : lobe_metadata(options.lobe))
                        merged[key] = value;
                files.push_back({&frame, pass, path, std::move(merged)});
            }
            const std::lock_guard lock(mutex);
            throw_if_over();
            frame.unwritten += files.size();
            submitted += files.size();
            for (File& file : files) queue.push_back(std::move(file));
        } catch (...) {
            give_back(frame);
            throw;
        }
        give_back(frame);
    }

    void give_back(Frame& frame) {
        {
            const std::lock_guard lock(mutex);
            release(frame);
        }
        changed.notify_all();
    }

    void finish() {
        std::unique_lock lock(mutex);
        changed.wait(lock, [this] { return queue.empty() && writing == 0; });
        finished = true;
        if (error) std::rethrow_exception(error);
        if (cancelled) throw Cancelled("the bake was cancelled");
    }

    SequenceOptions options;
    const RestState& rest;
    TexelCoverage coverage;
    std::vector<std::int32_t> corner_vert;
    std::vector<Tension> tensions;
    std::vector<float> values, corners;

    std::mutex frame_mutex;
    mutable std::mutex mutex;  // all below
    std::condition_variable changed;
    std::deque<Frame> frames;
    std::vector<Frame*> free;
    std::deque<File> queue;
    std::size_t writing = 0, submitted = 0, written = 0;
    bool cancelled = false, finished = false, stopping = false;
    std::exception_ptr error;
    std::vector<std::thread> threads;
};

SequenceBaker::SequenceBaker(const MeshView& mesh, const RestState& rest, int width, int height,
                             const SequenceOptions& options)
    : state_(std::make_unique<State>(mesh, rest, width, height, options)) {}

SequenceBaker::~SequenceBaker() = default;

void SequenceBaker::frame(std::span<const Vec3f> deformed,
                          const std::map<std::string, std::string>& paths,
                          const Metadata& metadata) {
    state_->frame(state_->rest, deformed, paths, metadata);
}

void SequenceBaker::frame(const RestState& rest, std::span<const Vec3f> deformed,
                          const std::map<std::string, std::string>& paths,
                          const Metadata& metadata) {
    state_->frame(rest, deformed, paths, metadata);
}

void SequenceBaker::cancel() { state_->cancel(); }

void SequenceBaker::finish() { state_->finish(); }

std::size_t SequenceBaker::files_submitted() const {
    const std::lock_guard lock(state_->mutex);
    return state_->submitted;
}

std::size_t SequenceBaker::files_written() const {
    const std::lock_guard lock(state_->mutex);
    return state_->written;
}

const TexelCoverage& SequenceBaker::coverage() const { return state_->coverage; }

}  // namespace ltmd::inline v0
