// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "commands.h"
#include "errors.h"
#include "ltmd/errors.h"
#include "ltmd/exr.h"

namespace ltmd::cli {
namespace {

void print_channel(const ExrImage& image, std::size_t channel) {
    const std::size_t count = image.channels.size();
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    std::size_t not_finite = 0;
    for (std::size_t i = channel; i < image.pixels.size(); i += count) {
        const float value = image.pixels[i];
        if (!std::isfinite(value)) {
            ++not_finite;
            continue;
        }
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    std::printf("  %s:", image.channels[channel].c_str());
    if (lowest <= highest) std::printf(" %g to %g", lowest, highest);
    if (not_finite > 0) std::printf(" (%zu not finite)", not_finite);
    std::printf("\n");
}

int run(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
        try {
            const ExrImage image = read_exr(path);
            std::printf("%s: %d x %d\n", path.c_str(), image.width, image.height);
            for (std::size_t c = 0; c < image.channels.size(); ++c) print_channel(image, c);
            for (const auto& [key, value] : exr_metadata(path))
                std::printf("  %s = %s\n", key.c_str(), value.c_str());
        } catch (const FileError& error) {
            throw BadInput(error.what());
        }
    }
    return success;
}

}  // namespace

Command add_info(CLI::App& app) {
    CLI::App* parser =
        app.add_subcommand("info", "Print size, range of each channel, and metadata of EXR files");
    const auto paths = std::make_shared<std::vector<std::string>>();
    parser->add_option("FILE", *paths, "EXR files")->required();
    return {parser, [paths] { return run(*paths); }};
}

}  // namespace ltmd::cli
