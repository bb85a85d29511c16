// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ggx.h"

namespace ltmd::inline v0 {

template AnyDistribution<float>::AnyDistribution(GGX<float>);
template AnyDistribution<double>::AnyDistribution(GGX<double>);

}  // namespace ltmd::inline v0
