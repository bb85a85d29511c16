// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "ltmd/errors.h"
#include "parallel.h"

namespace ltmd::inline v0 {

/// out[j] = function(items[j]...), on threads in pieces of `grain`. Throws InvalidInput unless all
/// arrays have one length.
template <std::size_t grain = 4096, class Out, class Function, class... Items>
void for_items(std::span<Out> out, const Function& function, const Items&... items) {
    const auto require = [&](std::size_t given) {
        if (given != out.size())
            throw InvalidInput("arrays of " + std::to_string(given) + " and " +
                               std::to_string(out.size()) + " items; they must have one length");
    };
    (require(items.size()), ...);
    parallel_for(out.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j) out[j] = function(items[j]...);
    });
}

}  // namespace ltmd::inline v0
