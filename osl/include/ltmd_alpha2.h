// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd_tension.h"

// The alpha^2 matrix of a lobe under a linear map M of the surface: a function of s^t Sigma^-1 s
// becomes one with Sigma' = h^2 M^-t Sigma M^-1 (microsurface transformations, section 3).

// Row-major [[xx, xy], [yx, yy]].
struct LtmdMatrix {
    float xx;
    float xy;
    float yx;
    float yy;
};

LtmdMatrix ltmd_product(LtmdMatrix a, LtmdMatrix b)
{
    LtmdMatrix m = { a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy,
                     a.yx * b.xx + a.yy * b.yx, a.yx * b.xy + a.yy * b.yy };
    return m;
}

LtmdMatrix ltmd_rotation(float angle)
{
    float c = cos(angle), s = sin(angle);
    LtmdMatrix m = { c, -s, s, c };
    return m;
}

// Eigenvalues of M M^t (the squared principal stretches) and the direction of the larger one,
// in radians from X.
void ltmd_principal(LtmdMatrix m, output float largest, output float smallest, output float angle)
{
    float xx = m.xx * m.xx + m.xy * m.xy;
    float xy = m.xx * m.yx + m.xy * m.yy;
    float yy = m.yx * m.yx + m.yy * m.yy;
    float det = m.xx * m.yy - m.xy * m.yx;
    largest = (xx + yy) / 2 + hypot((xx - yy) / 2, xy);
    smallest = det * det / largest;  // the difference of the two terms would cancel
    angle = atan2(2 * xy, xx - yy) / 2;
}

// T_s = V^s Rot(s phi) with the polar decomposition T = V Rot(phi): 0 is no deformation, 1 is T.
LtmdMatrix ltmd_strengthened(vector t, float strength)
{
    LtmdMatrix full = { t[0], t[1], 0, t[2] };
    if (strength == 1)
        return full;
    float largest, smallest, angle;
    ltmd_principal(full, largest, smallest, angle);
    float a = pow(largest, strength / 2), b = pow(smallest, strength / 2);
    float c = cos(angle), s = sin(angle);
    LtmdMatrix stretch = { a * c * c + b * s * s, (a - b) * c * s,
                           (a - b) * c * s, a * s * s + b * c * c };
    return ltmd_product(stretch, ltmd_rotation(strength * atan2(-t[1], t[0] + t[2])));
}

// The material's own anisotropy M0 = Rot(rotation) [[1, shear], [0, 1]] M_s, stretch s in (-1, 1)
// by eq. 31.
LtmdMatrix ltmd_material_matrix(float stretch, float rotation, float shear)
{
    float s = clamp(stretch, -0.99, 0.99);
    float sx = s < 0 ? 1 + s : 1 / (1 - s);
    LtmdMatrix m = { sx, shear / sx, 0, 1 / sx };
    return ltmd_product(ltmd_rotation(rotation), m);
}

// The map of the surface M = T_strength M0; heights are scaled by det(T_strength)^-height_response.
LtmdMatrix ltmd_surface_map(vector tension, LtmdMatrix m0, float strength, float height_response,
                            output float heights)
{
    LtmdMatrix m = m0;
    heights = 1;
    // Written so that it is constant where nothing is linked.
    if (strength != 0 && !(tension[0] == 1 && tension[1] == 0 && tension[2] == 1)) {
        LtmdMatrix ts = ltmd_strengthened(ltmd_usable_tension(tension), strength);
        if (height_response != 0)
            heights = pow(ts.xx * ts.yy - ts.xy * ts.yx, -height_response);
        m = ltmd_product(ts, m0);
    }
    return m;
}

// Isotropic lobes under that map: alpha_x = scale_x alpha belongs to the unit vector
// (along, across) in (X, Y) and is the smaller one, alpha_y = scale_y alpha to the direction across
// it.
void ltmd_lobe_scales(vector tension, LtmdMatrix m0, float strength, float height_response,
                      output float scale_x, output float scale_y, output float along,
                      output float across)
{
    float heights;
    LtmdMatrix m = ltmd_surface_map(tension, m0, strength, height_response, heights);
    // Eigenvalues and eigenvector of M M^t, the latter without angles.
    float xx = m.xx * m.xx + m.xy * m.xy;
    float xy = m.xx * m.yx + m.xy * m.yy;
    float yy = m.yx * m.yx + m.yy * m.yy;
    float det = m.xx * m.yy - m.xy * m.yx;
    float half_difference = (xx - yy) / 2;
    float radius = hypot(half_difference, xy);
    float largest = (xx + yy) / 2 + radius;
    along = 1;
    across = 0;
    if (radius <= 1e-6 * largest) {
        // A tangent is not needed, and rounding may not make one needed.
        scale_x = heights / sqrt(abs(det));
        scale_y = scale_x;
    } else {
        scale_x = heights / sqrt(largest);
        scale_y = heights * sqrt(largest) / abs(det);
        along = half_difference >= 0 ? half_difference + radius : xy;
        across = half_difference >= 0 ? xy : radius - half_difference;
        float length = hypot(along, across);
        along /= length;
        across /= length;
    }
}
