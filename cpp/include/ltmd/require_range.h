// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/export.h"

namespace ltmd::inline v0 {

/// `value` itself if it is in [low, high], else throws InvalidInput that gives its name, the value
/// and the range; not a number is refused.
LTMD_API double require_range(const char* name, double value, double low, double high);

}  // namespace ltmd::inline v0
