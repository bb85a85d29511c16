// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/export.h"

namespace ltmd::inline v0 {

/// Sets how many threads the library uses, 1 to 1024; 0 = one per core, the default. Results have
/// the same bits for any count.
LTMD_API void set_thread_count(int count);

/// The number of threads in use, at least 1.
LTMD_API int thread_count();

}  // namespace ltmd::inline v0
