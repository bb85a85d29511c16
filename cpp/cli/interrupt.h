// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ltmd::cli {

/// From here on the first Ctrl-C (or SIGTERM) only sets a mark, so that work ends between two
/// files; the second one ends the process at once.
void watch_for_interrupt();

bool is_interrupted();

}  // namespace ltmd::cli
