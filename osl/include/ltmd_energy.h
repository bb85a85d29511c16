// SPDX-License-Identifier: Apache-2.0
#pragma once

// Energy of the closures: what one reflection loses, and what closures make of lobes beyond their
// bound of alpha.

#include "ltmd_albedo_fit.h"
#include "ltmd_surface.h"

// 1 / albedo of a lobe's closure towards the viewer, where F = 1.
float ltmd_closure_gain(int ggx, LtmdSurface surface, float alpha)
{
    // Cycles bounds alpha by 1.
    float ax = min(alpha * surface.scale_x, 1.0), ay = min(alpha * surface.scale_y, 1.0);
    float z = max(dot(I, surface.shading), 1e-3), s2 = 1 - z * z;
    float along = ax * ax, across = along, both = 0;
    if (ax != ay && s2 > 0) {
        float vx = dot(I, surface.smooth);
        float cos2 = clamp(vx * vx / s2, 0.0, 1.0), sin2 = 1 - cos2;
        along = ax * ax * cos2 + ay * ay * sin2;
        across = ax * ax * sin2 + ay * ay * cos2;
        both = (ay * ay - ax * ax) * (ay * ay - ax * ax) * cos2 * sin2;
    }
    float c = both / max(along * across, 1e-12), x = z / sqrt(z * z + along * s2);
    float a = sqrt(along), p = sqrt(across);
    return max(1.0, ggx ? ltmd_ggx_gain(a, p, c, x) : ltmd_beckmann_gain(a, p, c, x));
}

// Lambda of a view whose slope, in units of the lobe's alpha, is `tangent`; Beckmann's is the fit of
// Cycles' closure (masking-shadowing, eq. 69).
float ltmd_closure_lambda(int ggx, float tangent)
{
    float lambda = 0;
    if (ggx) {
        lambda = (sqrt(1 + tangent * tangent) - 1) / 2;
    } else if (tangent > 0.625) {
        float a = 1 / tangent;
        lambda = (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a);
    }
    return lambda;
}

// What a microfacet of the normal (q, 1) reflects from the viewer v, per area of the macrosurface
// and before masking by the viewer's direction alone.
float ltmd_reflected_part(int ggx, vector q, vector v, float lambda, float ax, float ay)
{
    float part = 0;
    float facing = dot(q, v);
    if (facing > 0) {
        vector o = 2 * facing / dot(q, q) * q - v;
        if (o[2] > 0)
            part = facing / v[2] /
                   (1 + lambda + ltmd_closure_lambda(ggx, hypot(ax * o[0], ay * o[1]) / o[2]));
    }
    return part;
}

// A random number with the albedo towards the viewer as its mean, for any alpha: over pairs of
// opposite slopes from the lobe's distribution, spread evenly. Its standard deviation is about 15 %
// with 8 pairs, 45 % with 2.
// Cycles has no closure for alpha > 1, which squeezes lead to; one with alpha = 1, scaled to the
// albedo of the lobe, keeps light sampling. Beyond alpha = 4 hardly a facet reflects: it is as at 4.
float ltmd_random_albedo(int ggx, LtmdSurface surface, float alpha, int pairs)
{
    float ax = min(alpha * surface.scale_x, 4.0), ay = min(alpha * surface.scale_y, 4.0);
    vector X = surface.scale_x == surface.scale_y ? ltmd_frame_x(vector(0), surface.shading)
                                                  : surface.smooth;
    vector v = vector(dot(I, X), dot(I, cross(surface.shading, X)),
                      max(dot(I, surface.shading), 1e-3));
    float lambda = ltmd_closure_lambda(ggx, hypot(ax * v[0], ay * v[1]) / v[2]);
    float turn = hashnoise(P, 11 + alpha), shift = hashnoise(P, 12 + alpha);
    float sum = 0;
    for (int k = 0; k < pairs; k += 1) {
        float u = (k + shift) / pairs, phi = M_2PI * (turn + 0.618034 * k);
        float slope = sqrt(ggx ? u / (1 - u) : -log(1 - u));
        float x = ax * slope * cos(phi), y = ay * slope * sin(phi);
        sum += ltmd_reflected_part(ggx, vector(x, y, 1), v, lambda, ax, ay) +
               ltmd_reflected_part(ggx, vector(-x, -y, 1), v, lambda, ax, ay);
    }
    return sum / (2 * pairs);
}

// Factor for all closures together that gives back the light lost by single scattering: none of it
// for amount 0, all for 1. `gain`: 1 / albedo; of each further reflection the surface keeps
// `reflectance`.
color ltmd_energy_gain(float amount, float gain, color reflectance)
{
    return 1 + amount * (gain - 1) * reflectance;
}
