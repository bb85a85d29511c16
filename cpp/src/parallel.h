// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace ltmd::inline v0 {

/// Calls body(begin, end) over [0, count) in pieces of `grain`, on thread_count() threads, and
/// waits. Pieces do not depend on the thread count, so a body that writes only its own piece gives
/// the same bits for any. The first exception is thrown again.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace ltmd::inline v0
