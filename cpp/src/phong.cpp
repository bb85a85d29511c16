// SPDX-License-Identifier: Apache-2.0
#include "ltmd/phong.h"

namespace ltmd::inline v0 {

template AnyDistribution<float>::AnyDistribution(Phong<float>);
template AnyDistribution<double>::AnyDistribution(Phong<double>);

}  // namespace ltmd::inline v0
