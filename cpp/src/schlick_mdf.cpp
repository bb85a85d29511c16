// SPDX-License-Identifier: Apache-2.0
#include "ltmd/schlick_mdf.h"

namespace ltmd::inline v0 {

template AnyDistribution<float>::AnyDistribution(SchlickMDF<float>);
template AnyDistribution<double>::AnyDistribution(SchlickMDF<double>);

}  // namespace ltmd::inline v0
