// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "ltmd/export.h"

namespace ltmd::inline v0 {

/// A shape, index or value that a function does not take; the message says what was given and what
/// is allowed.
class LTMD_API InvalidInput : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// A file that cannot be read, written or understood; the message starts with its path.
class LTMD_API FileError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Work that its caller cancelled.
class LTMD_API Cancelled : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace ltmd::inline v0
