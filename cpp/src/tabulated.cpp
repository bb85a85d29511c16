// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tabulated.h"

namespace ltmd::inline v0 {

template AnyDistribution<float>::AnyDistribution(Tabulated<float>);
template AnyDistribution<double>::AnyDistribution(Tabulated<double>);

}  // namespace ltmd::inline v0
