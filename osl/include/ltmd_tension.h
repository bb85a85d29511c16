// SPDX-License-Identifier: Apache-2.0
#pragma once

// Tension (t11, t12, t22): the matrix [[t11, t12], [0, t22]] with a positive diagonal that maps the
// rest surface to the deformed one, each in its own frame: x along dP/du, y = z x x, z the mesh's
// own (unflipped) normal. Identity = (1, 0, 1). Turning x and y by 180 degrees changes nothing, so
// the sign of a tangent never matters; its side (see ltmd_frame.h) does.

// A tension that is safe to use: not finite or without a positive diagonal -> identity; principal
// stretches clamped to [1e-3, 1e3], as the library clamps them. Blender's sockets turn infinity
// into the largest float, so anything huge counts as not finite. (OSL's comparisons are unordered:
// with a NaN each of them is true.)
vector ltmd_usable_tension(vector t)
{
    float size = max(abs(t[0]), max(abs(t[1]), abs(t[2])));
    if (!isfinite(t[0]) || !isfinite(t[1]) || !isfinite(t[2]) || size > 1e9 || t[0] <= 0 || t[2] <= 0)
        return vector(1, 0, 1);
    vector bounded = clamp(t, vector(-1e6), vector(1e6));
    // Eigenvalues of C = T^t T are the squared principal stretches.
    float cxx = bounded[0] * bounded[0];
    float cxy = bounded[0] * bounded[1];
    float cyy = bounded[1] * bounded[1] + bounded[2] * bounded[2];
    float area = bounded[0] * bounded[2];
    float largest = (cxx + cyy) / 2 + hypot((cxx - cyy) / 2, cxy);
    float smallest = area * area / largest;
    if (largest <= 1e6 && smallest >= 1e-6)
        return bounded;
    float angle = atan2(2 * cxy, cxx - cyy) / 2;
    float c = cos(angle), s = sin(angle);
    largest = clamp(largest, 1e-6, 1e6);
    smallest = clamp(smallest, 1e-6, 1e6);
    cxx = largest * c * c + smallest * s * s;
    cxy = (largest - smallest) * c * s;
    float t11 = sqrt(cxx);
    return vector(t11, cxy / t11, sqrt(largest * smallest) / t11);
}

// Tension from two edges of the deformed surface (e) and the same two at rest (r), the first along
// dP/du; n: the mesh's own normal. Independent of the edges' lengths and common sign.
// Microsurface transformations, section 5.1. No area -> identity.
vector ltmd_tension_of_edges(vector eu, vector ev, vector ru, vector rv, vector n)
{
    float area = length(cross(eu, ev));
    float rest_area = length(cross(ru, rv));
    if (area <= 0 || rest_area <= 1e-7 * max(dot(ru, ru), dot(rv, rv)))
        return vector(1, 0, 1);
    float side = dot(cross(eu, ev), n) < 0 ? -1 : 1;
    float au = length(eu), rest_au = length(ru);
    float t11 = au / rest_au;
    float t22 = (area / au) / (rest_area / rest_au);
    float t12 = (dot(eu, ev) / au - t11 * dot(ru, rv) / rest_au) * rest_au / (side * rest_area);
    return ltmd_usable_tension(vector(t11, t12, t22));
}
