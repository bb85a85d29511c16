// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd_lobes.h"

// The parameters that every LTMD material has.
#define LTMD_SURFACE_INPUTS                                                                       \
    float Stretch = 0 [[ float min = -0.99, float max = 0.99,                                     \
        string help = "Anisotropy at rest: positive draws the highlight across U" ]],             \
    float Rotation = 0 [[ string help = "Turns the anisotropy from U towards V, radians" ]],      \
    float Shear = 0 [[ string help = "Slants the anisotropy" ]],                                  \
    vector Tension = vector(1, 0, 1) [[ string help = "(t11, t12, t22); identity 1 0 1" ]],       \
    vector Tangent = 0 [[ string help = "dP/du of the UV map the tension belongs to; 0: any" ]],  \
    normal Normal = 0 [[ string help = "Shading normal; 0: the surface's own" ]],                 \
    float Strength = 1 [[ float min = 0,                                                          \
        string help = "0 ignores the deformation, 1 is exact" ]],                                 \
    float HeightResponse = 0 [[ string help =                                                     \
        "0: the microsurface keeps its heights; 1: it keeps its volume" ]]

#define LTMD_ROUGHNESS_INPUTS                                                                     \
    float Roughness = 0.5 [[ float min = 0, float max = 1, string help = "Roughness at rest" ]],  \
    int RoughnessIsAlpha = 0 [[ string widget = "checkBox",                                       \
        string help = "0: alpha is the square of Roughness; 1: it is Roughness" ]]

#define LTMD_COMMON_INPUTS                                                                        \
    LTMD_ROUGHNESS_INPUTS,                                                                        \
    float Tail = 2 [[ float min = 0, float max = 4,                                               \
        string help = "Gamma of GTR: 2 is GGX, lower has longer tails" ]],                        \
    LTMD_SURFACE_INPUTS,                                                                          \
    int Lobes = 0 [[ int min = 0, int max = 6, string help = "0: as many as Tail needs" ]],       \
    int Mode = 0 [[ int min = 0, int max = 2,                                                     \
        string help = "0: sum of lobes; 1: one lobe at random; 2: random normals" ]],             \
    float PreserveEnergy = 0 [[ float min = 0, float max = 1,                                     \
        string help = "Adds light that is reflected several times" ]],                            \
    float LobeTable[LTMD_LOBE_TABLE_SIZE] = { LTMD_LOBE_TABLE }

// The surface that these parameters describe.
#define LTMD_SURFACE                                                                              \
    ltmd_surface(Normal, Tangent, Tension, Stretch, Rotation, Shear, Strength, HeightResponse)
