// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "ltmd/errors.h"
#include "parallel.h"

namespace ltmd::inline v0 {

/// function(pointers to a piece of each of the items and of out, its length), on threads in pieces
/// of `grain`. Throws InvalidInput unless all arrays have one length.
template <std::size_t grain = 4096, class Out, class Function, class... Items>
void for_pieces(std::span<Out> out, const Function& function, const Items&... items) {
    const auto require = [&](std::size_t given) {
        if (given != out.size())
            throw InvalidInput("arrays of " + std::to_string(given) + " and " +
                               std::to_string(out.size()) + " items; they must have one length");
    };
    (require(items.size()), ...);
    parallel_for(out.size(), grain, [&](std::size_t begin, std::size_t end) {
        function((items.data() + begin)..., out.data() + begin, end - begin);
    });
}

/// out[j] = function(items[j]...), in the same way.
template <std::size_t grain = 4096, class Out, class Function, class... Items>
void for_items(std::span<Out> out, const Function& function, const Items&... items) {
    const auto each = [&](const typename Items::value_type*... piece, Out* to, std::size_t count) {
        for (std::size_t j = 0; j < count; ++j) to[j] = function(piece[j]...);
    };
    for_pieces<grain>(out, each, items...);
}

}  // namespace ltmd::inline v0
