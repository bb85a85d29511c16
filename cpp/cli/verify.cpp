// SPDX-License-Identifier: Apache-2.0
#include "ltmd/verify.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "errors.h"
#include "frame_numbers.h"
#include "ltmd/errors.h"

namespace ltmd::cli {
namespace {

struct Options {
    std::string directory, frames;
};

int run(const Options& options) {
    const std::vector<int> frames = parse_frames(options.frames);
    VerifyReport report;
    try {
        report = verify(options.directory, frames);
    } catch (const FileError& error) {
        throw BadInput(error.what());
    }
    for (const auto& [name, found] : report.sequences) {
        if (found.empty()) continue;
        std::printf("%s: %zu %s, %d to %d\n", name.c_str(), found.size(),
                    found.size() == 1 ? "frame" : "frames", found.front(), found.back());
    }
    for (const std::string& problem : report.problems)
        std::fprintf(stderr, "ltmd: %s\n", problem.c_str());
    return report.ok() ? success : problems_found;
}

}  // namespace

Command add_verify(CLI::App& app) {
    CLI::App* parser =
        app.add_subcommand("verify",
                           "Check every baked sequence in a folder: exit code 1 if one is "
                           "incomplete or damaged");
    const auto options = std::make_shared<Options>();
    parser->add_option("DIR", options->directory, "The folder")->required();
    parser->add_option("--frames", options->frames,
                       "Frames that must exist: 7, 1-24, 1-10,20 or 1-24x2 (default: those that "
                       "the files name)");
    return {parser, [options] { return run(*options); }};
}

}  // namespace ltmd::cli
