// SPDX-License-Identifier: Apache-2.0
#pragma once

// Fresnel factors of unpolarised light, for what does not go through a closure that has its own.
// cosine: of the angle between the viewer and the microfacet's normal.

color ltmd_fresnel_conductor(float cosine, color n, color k)
{
    float c = clamp(cosine, 0.0, 1.0), c2 = c * c, s2 = 1 - c2;
    color n2 = n * n, k2 = k * k;
    color difference = n2 - k2 - s2;
    color both = sqrt(difference * difference + 4 * n2 * k2);
    color a = sqrt(max((both + difference) / 2, color(0)));
    color across = (both + c2 - 2 * c * a) / (both + c2 + 2 * c * a);
    color p = c2 * both + s2 * s2, q = 2 * c * s2 * a;
    return across * (1 + (p - q) / (p + q)) / 2;
}

// Schlick's curve from the colour seen straight on, tinted at about 82 degrees (cosine 1/7).
color ltmd_fresnel_f82(float cosine, color base, color tint)
{
    float c = clamp(cosine, 0.0, 1.0);
    float rise = pow(1 - c, 5);
    color edge = base + (1 - base) * pow(6.0 / 7, 5);
    color drop = edge * (7 / pow(6.0 / 7, 6)) * (1 - tint);
    return clamp(base + (1 - base) * rise - drop * c * rise * (1 - c), color(0), color(1));
}

float ltmd_fresnel_dielectric(float cosine, float ior)
{
    float c = clamp(cosine, 0.0, 1.0);
    float g2 = ior * ior - 1 + c * c;
    float result = 1;
    if (g2 > 0) {
        float g = sqrt(g2);
        float across = (g - c) / (g + c);
        float along = (c * (g + c) - 1) / (c * (g - c) + 1);
        result = across * across * (1 + along * along) / 2;
    }
    return result;
}
