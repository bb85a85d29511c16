// SPDX-License-Identifier: Apache-2.0
#include "ltmd/require_range.h"

#include "ltmd/errors.h"
#include "text.h"

namespace ltmd::inline v0 {

double require_range(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return value;
    throw InvalidInput(text(name, " is ", value, "; it must be in [", low, ", ", high, "]"));
}

}  // namespace ltmd::inline v0
