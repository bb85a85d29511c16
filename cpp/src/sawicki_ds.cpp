// SPDX-License-Identifier: Apache-2.0
#include "ltmd/sawicki_ds.h"

namespace ltmd::inline v0 {

template AnyDistribution<float>::AnyDistribution(SawickiDS<float>);
template AnyDistribution<double>::AnyDistribution(SawickiDS<double>);

}  // namespace ltmd::inline v0
