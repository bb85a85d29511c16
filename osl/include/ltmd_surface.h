// SPDX-License-Identifier: Apache-2.0
#pragma once

// The deformed surface as closures see it: one frame for all lobes of an isotropic distribution,
// because M turns and scales them alike.

#include "ltmd_alpha2.h"
#include "ltmd_frame.h"

struct LtmdSurface {
    normal shading;   // towards the viewer
    vector smooth;    // direction of alpha_x, the smaller one; not used where both are equal
    float scale_x;    // alpha_x and alpha_y of a lobe, per alpha at rest
    float scale_y;
};

LtmdSurface ltmd_surface(normal shading_normal, vector tangent, vector tension, float stretch,
                         float rotation, float shear, float strength, float height_response)
{
    LtmdSurface surface;
    surface.shading = dot(shading_normal, shading_normal) > 0 ? normalize(shading_normal) : N;
    surface.smooth = 0;
    float along, across;
    ltmd_lobe_scales(tension, ltmd_material_matrix(stretch, rotation, shear), strength,
                     height_response, surface.scale_x, surface.scale_y, along, across);
    if (surface.scale_x != surface.scale_y) {
        normal side = ltmd_mesh_side(surface.shading, dPdu, dPdv, Ng);
        vector X = ltmd_frame_x(tangent, side);
        surface.smooth = along * X + across * cross(side, X);
    }
    return surface;
}

// What Lambda of a lobe needs to know of the viewer: v_z, and v's projection to the plane in units
// of the slopes, so that alpha * across / z is alpha tan(theta).
void ltmd_view(LtmdSurface surface, output float z, output float across)
{
    z = max(dot(I, surface.shading), 0.0);
    if (surface.scale_x == surface.scale_y) {
        across = surface.scale_x * sqrt(max(1 - z * z, 0.0));
    } else {
        across = hypot(surface.scale_x * dot(I, surface.smooth),
                       surface.scale_y * dot(I, cross(surface.shading, surface.smooth)));
    }
}
