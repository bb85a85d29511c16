// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd_lobes.h"

// Factor for the closures of the lobes that gives back the light lost by single scattering, from 1
// (amount 0) to all of it.
color ltmd_energy_gain(float amount, LtmdSurface surface, LtmdLobes lobes, color reflectance)
{
    return color(1);
}
