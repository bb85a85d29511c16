// SPDX-License-Identifier: Apache-2.0
#include "ltmd/beckmann.h"

namespace ltmd::inline v0 {

template AnyDistribution<float>::AnyDistribution(Beckmann<float>);
template AnyDistribution<double>::AnyDistribution(Beckmann<double>);

}  // namespace ltmd::inline v0
