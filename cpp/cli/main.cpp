// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "errors.h"
#include "ltmd/errors.h"
#include "ltmd/version.h"

namespace {

int failed(int code, const std::string& sentence) {
    std::fprintf(stderr, "ltmd: %s\n", sentence.c_str());
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace ltmd::cli;
    CLI::App app("Measures how a mesh deforms, and bakes it to EXR textures; converts roughness.",
                 "ltmd");
    app.set_version_flag("--version", "ltmd " + std::to_string(LTMD_VERSION_MAJOR) + "." +
                                          std::to_string(LTMD_VERSION_MINOR) + "." +
                                          std::to_string(LTMD_VERSION_PATCH));
    app.footer(
        "Exit codes: 0 done, 1 problems found, 2 wrong arguments, 3 an input that cannot be used, "
        "4 a file\ncould not be written, 130 interrupted (files already written are whole).");
    app.require_subcommand(1);
    const Command commands[] = {add_tension(app), add_verify(app), add_info(app), add_convert(app)};
    try {
        app.parse(argc, argv);
        for (const Command& command : commands)
            if (command.parser->parsed()) return command.run();
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? success : wrong_usage;
    } catch (const UsageError& error) {
        return failed(wrong_usage, error.what());
    } catch (const BadInput& error) {
        return failed(bad_input, error.what());
    } catch (const ltmd::InvalidInput& error) {
        return failed(bad_input, error.what());
    } catch (const ltmd::Cancelled&) {
        return failed(interrupted, "interrupted");
    } catch (const ltmd::FileError& error) {
        return failed(write_failed, error.what());
    } catch (const std::bad_alloc&) {
        return failed(write_failed, "not enough memory; take a smaller --size");
    } catch (const std::exception& error) {
        return failed(write_failed, error.what());
    }
    return wrong_usage;
}
