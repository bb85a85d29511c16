// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

/// How the command ends; the help states the same numbers.
namespace ltmd::cli {

enum ExitCode {
    success = 0,
    problems_found = 1,
    wrong_usage = 2,
    bad_input = 3,
    write_failed = 4,
    interrupted = 130,  ///< As shells report Ctrl-C.
};

/// Arguments that do not fit together, or not to the files.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A file that was given and cannot be used.
class BadInput : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace ltmd::cli
