// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <locale>
#include <sstream>
#include <string>

namespace ltmd::inline v0 {

/// The parts in one string, numbers with a decimal point whatever the locale.
std::string text(const auto&... parts) {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    (stream << ... << parts);
    return stream.str();
}

}  // namespace ltmd::inline v0
