// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tension.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "commands.h"
#include "errors.h"
#include "frame_numbers.h"
#include "interrupt.h"
#include "ltmd/errors.h"
#include "ltmd/lobe_parameters.h"
#include "ltmd/passes.h"
#include "ltmd/sequence_baker.h"
#include "ltmd/texel_coverage.h"
#include "ltmd/threads.h"
#include "obj_mesh.h"
#include "output_pattern.h"

namespace ltmd::cli {
namespace {

constexpr int largest_size = 65536;
constexpr double most_overlap = 0.001;

const std::map<std::string, Per> per_names = {
    {"corner", Per::corner}, {"vertex", Per::vertex}, {"triangle", Per::triangle}};
const std::map<std::string, Compression> compression_names = {{"none", Compression::none},
                                                              {"zips", Compression::zips},
                                                              {"zip", Compression::zip},
                                                              {"piz", Compression::piz}};

struct Options {
    std::string rest;
    std::vector<std::string> deformed, outputs, passes = {"tension"};
    std::string size = "2048", frames;
    std::vector<int> tiles;
    int threads = 0;
    bool allow_overlap = false, quiet = false;
    std::string per = "corner", compression = "zip";
    int margin = 16;
    Precision precision;
    std::vector<double> alpha, anisotropy;
    Lobe lobe;
};

/// `2048` or `2048x1024`.
std::array<int, 2> parse_size(const std::string& text) {
    const std::size_t times = text.find('x');
    const auto number = [&](const std::string& part) {
        int value = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (error != std::errc() || end != part.data() + part.size() || value < 1 ||
            value > largest_size)
            throw UsageError("a size is 1 to 65536 pixels, such as 2048 or 2048x1024, not '" +
                             text + "'");
        return value;
    };
    const int width = number(text.substr(0, times));
    return {width, times == std::string::npos ? width : number(text.substr(times + 1))};
}

Lobe lobe_of(const Options& options) {
    Lobe lobe = options.lobe;
    if (!options.alpha.empty()) {
        lobe.alpha_x = options.alpha.front();
        lobe.alpha_y = options.alpha.back();
    }
    try {
        const std::vector<double>& m0 = options.anisotropy;
        if (!m0.empty()) lobe.m0 = material_matrix(m0[0], m0[1], m0[2]);
        validate(lobe);
    } catch (const InvalidInput& error) {
        throw UsageError(error.what());
    }
    return lobe;
}

void warn(std::size_t count, const char* what) {
    if (count > 0) std::fprintf(stderr, "ltmd: warning: %zu %s\n", count, what);
}

class TensionBake {
public:
    explicit TensionBake(const Options& options)
        : options_(options), output_(options.outputs, options.passes) {
        size_ = parse_size(options.size);
        lobe_ = lobe_of(options);
        const std::vector<int> given = parse_frames(options.frames);
        if (!given.empty() && given.size() != options.deformed.size())
            throw UsageError("--frames names " + std::to_string(given.size()) + " frames for " +
                             std::to_string(options.deformed.size()) + " deformed files");
        if (output_.has_frame())
            frames_ = given.empty() ? frames_of_files(options.deformed) : given;
        else if (options.deformed.size() > 1)
            throw UsageError("several deformed files would be written to one; put <frame> into -o");
        for (const std::string& path : options.deformed) {
            std::error_code error;
            if (!std::filesystem::is_regular_file(path, error))
                throw BadInput(path + ": there is no such file");
        }
        set_thread_count(options.threads);
        mesh_ = read_rest(options.rest);
        rest_.emplace(mesh_.view(), mesh_.positions);
        report_mesh();
        tiles_ = chosen_tiles();
    }

    int run() {
        watch_for_interrupt();
        for (const Tile& tile : tiles_)
            if (!bake_tile(tile)) {
                std::fprintf(stderr, "ltmd: interrupted after %zu of %zu files\n", files_,
                             all_files());
                return interrupted;
            }
        return success;
    }

private:
    void report_mesh() const {
        const RestReport& report = rest_->report();
        warn(report.degenerate_triangles, "triangles without area count as undeformed");
        warn(report.no_uv_triangles, "triangles without UV area count as undeformed");
        const double overlap = overlap_fraction(mesh_.view());
        if (overlap <= most_overlap) return;
        char percent[16];
        std::snprintf(percent, sizeof percent, "%.1f %%", 100 * overlap);
        const std::string sentence = options_.rest + ": faces overlap on " + percent +
                                     " of the UV map, where a texture can hold only one of them";
        if (!options_.allow_overlap)
            throw BadInput(sentence + "; use a UV map without overlap, or --allow-overlap");
        std::fprintf(stderr, "ltmd: warning: %s\n", sentence.c_str());
    }

    std::vector<Tile> chosen_tiles() const {
        std::map<int, Tile> found;
        std::string names;
        for (const Tile& tile : ltmd::tiles(mesh_.view())) {
            found[udim(tile)] = tile;
            names += (names.empty() ? "" : ", ") + std::to_string(udim(tile));
        }
        if (found.empty()) throw BadInput(options_.rest + ": no face has area in its UV map");
        std::vector<Tile> chosen;
        for (const int number : options_.tiles) {
            if (!found.contains(number))
                throw BadInput(options_.rest + ": has no faces in tile " + std::to_string(number) +
                               ", only in " + names);
            chosen.push_back(found[number]);
        }
        if (chosen.empty())
            for (const auto& [number, tile] : found) chosen.push_back(tile);
        if (chosen.size() > 1 && !output_.has_udim())
            throw UsageError(options_.rest + " has UVs in the tiles " + names +
                             "; put <UDIM> into -o, or take one with --tile");
        return chosen;
    }

    std::size_t all_files() const {
        return tiles_.size() * options_.deformed.size() * options_.passes.size();
    }

    /// Whether it came to its end.
    bool bake_tile(const Tile& tile) {
        SequenceOptions sequence;
        sequence.passes = options_.passes;
        sequence.margin = options_.margin;
        sequence.tile = tile;
        sequence.per = per_names.at(options_.per);
        sequence.compression = compression_names.at(options_.compression);
        sequence.precision = options_.precision;
        sequence.lobe = lobe_;
        sequence.metadata = {{"ltmd:object", stem(options_.rest)},
                             {"ltmd:rest", "file:" + file_name(options_.rest)}};
        if (!frames_.empty()) {
            const auto [first, last] = std::minmax_element(frames_.begin(), frames_.end());
            sequence.metadata["ltmd:frame_start"] = std::to_string(*first);
            sequence.metadata["ltmd:frame_end"] = std::to_string(*last);
        }
        SequenceBaker baker(mesh_.view(), *rest_, size_[0], size_[1], sequence);
        for (std::size_t i = 0; i < options_.deformed.size(); ++i) {
            const std::vector<Vec3f>& positions = deformed(i);
            if (is_interrupted()) return stop(baker);
            std::map<std::string, std::string> paths;
            Metadata metadata;
            const auto frame = frames_.empty() ? std::nullopt : std::optional(frames_[i]);
            if (frame) metadata["ltmd:frame"] = std::to_string(*frame);
            for (const std::string& pass : options_.passes) {
                paths[pass] = output_.path({pass, udim(tile), frame});
                make_folder(paths[pass]);
            }
            baker.frame(positions, paths, metadata);
            progress(options_.deformed[i], tile);
        }
        if (is_interrupted()) return stop(baker);
        baker.finish();
        files_ += baker.files_written();
        return true;
    }

    bool stop(SequenceBaker& baker) {
        baker.cancel();
        try {
            baker.finish();
        } catch (const Cancelled&) {
        }
        files_ += baker.files_written();
        return false;
    }

    /// The last file is kept: one deformed state is read once for all tiles.
    const std::vector<Vec3f>& deformed(std::size_t index) {
        if (read_ != index) {
            positions_ = read_deformed(options_.deformed[index], mesh_);
            read_ = index;
        }
        return positions_;
    }

    static void make_folder(const std::string& path) {
        const std::filesystem::path folder = std::filesystem::path(path).parent_path();
        std::error_code error;
        if (!folder.empty()) std::filesystem::create_directories(folder, error);
        if (error) throw FileError(path + ": its folder cannot be made (" + error.message() + ")");
    }

    void progress(const std::string& path, const Tile& tile) {
        ++done_;
        if (!options_.quiet)
            std::fprintf(stderr, "ltmd: %s, tile %d (%zu of %zu)\n", file_name(path).c_str(),
                         udim(tile), done_, tiles_.size() * options_.deformed.size());
    }

    static std::string file_name(const std::string& path) {
        return std::filesystem::path(path).filename().string();
    }
    static std::string stem(const std::string& path) {
        return std::filesystem::path(path).stem().string();
    }

    const Options& options_;
    OutputPattern output_;
    std::array<int, 2> size_{};
    Lobe lobe_;
    std::vector<int> frames_;  // empty: the files carry no frame
    ObjMesh mesh_;
    std::optional<RestState> rest_;
    std::vector<Tile> tiles_;
    std::vector<Vec3f> positions_;
    std::optional<std::size_t> read_;
    std::size_t done_ = 0, files_ = 0;
};

}  // namespace

Command add_tension(CLI::App& app) {
    CLI::App* parser = app.add_subcommand(
        "tension", "Measure deformed states of a mesh against its rest state and write textures");
    const auto options = std::make_shared<Options>();
    parser->add_option("REST", options->rest, "OBJ file of the undeformed mesh, with UVs")
        ->required();
    parser
        ->add_option("DEFORMED", options->deformed,
                     "OBJ files of deformed states: same vertices and faces")
        ->required();
    parser
        ->add_option("-o,--output", options->outputs,
                     "EXR file to write, with <UDIM>, <frame> and <pass> where there are several; "
                     "may be given once for each pass")
        ->required()
        ->allow_extra_args(false);
    parser->add_option("--pass", options->passes, "What to write (default: tension)")
        ->check(CLI::IsMember(std::vector<std::string>(pass_names().begin(), pass_names().end())))
        ->delimiter(',')
        ->allow_extra_args(false);
    parser->add_option("--size", options->size, "Pixels: 2048 or 2048x1024 (default: 2048)");
    parser->add_option("--frames", options->frames,
                       "Frame numbers of the deformed files: 1-24, 1-10,20 or 1-24x2 (default: the "
                       "last digits in their names)");
    parser->add_option("--tile", options->tiles, "UDIM tiles to write (default: all)")
        ->delimiter(',')
        ->allow_extra_args(false);
    parser->add_option("--margin", options->margin, "Pixels around charts (default: 16)")
        ->check(CLI::Range(0, 64));
    parser
        ->add_option("--per", options->per,
                     "Average over each corner's UV fan (default), each vertex, or not at all")
        ->check(CLI::IsMember({"corner", "vertex", "triangle"}));
    parser->add_option("--compression", options->compression, "Lossless (default: zip)")
        ->check(CLI::IsMember({"none", "zips", "zip", "piz"}));
    parser->add_flag("--half", options->precision.half, "16-bit float");
    parser
        ->add_option("--mantissa-bits", options->precision.mantissa_bits,
                     "Round pixels to this many bits, so that files are smaller (default: not)")
        ->check(CLI::Range(1, full_mantissa));
    parser
        ->add_option("--alpha", options->alpha,
                     "Of the passes alpha2 and roughness: the lobe's alpha at rest, or its alphas "
                     "along U and V (default: 0.5)")
        ->type_name("A[,A]")
        ->expected(1, 2)
        ->delimiter(',')
        ->allow_extra_args(false);
    parser
        ->add_option("--m0", options->anisotropy,
                     "The material's own anisotropy: stretch, rotation (radians), shear")
        ->type_name("S,R,H")
        ->expected(3)
        ->delimiter(',')
        ->allow_extra_args(false);
    parser->add_option("--strength", options->lobe.strength,
                       "How much of the deformation the lobe follows (default: 1)");
    parser->add_option("--height-response", options->lobe.height_response,
                       "0: heights are kept (default), 1: volume is kept");
    parser->add_option("--threads", options->threads, "0: one per core (default)")
        ->check(CLI::Range(0, 1024));
    parser->add_flag("--allow-overlap", options->allow_overlap,
                     "Bake UV maps that use texels twice");
    parser->add_flag("--quiet", options->quiet, "No progress on stderr");
    parser->footer(
        "Quads are cut along their shorter diagonal at rest, larger polygons by ear clipping.\n"
        "Example: ltmd tension rest.obj face.*.obj -o \"out/face_<pass>.<UDIM>.<frame>.exr\" "
        "--pass tension,stretch");
    return {parser, [options] { return TensionBake(*options).run(); }};
}

}  // namespace ltmd::cli
