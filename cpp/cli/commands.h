// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace ltmd::cli {

/// A subcommand's work, run after parsing; returns an ExitCode or throws.
struct Command {
    CLI::App* parser;
    std::function<int()> run;
};

Command add_tension(CLI::App& app);
Command add_verify(CLI::App& app);
Command add_info(CLI::App& app);
Command add_convert(CLI::App& app);

}  // namespace ltmd::cli
