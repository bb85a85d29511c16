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
    // Surely in range, by the trace and the determinant of T^t T.
    float trace = dot(t, t), area = t[0] * t[2];
    if (isfinite(trace) && t[0] > 0 && t[2] > 0 && trace <= 1e6 && area * area >= 1e-6 * trace)
        return t;
    float size = max(abs(t[0]), max(abs(t[1]), abs(t[2])));
    if (!isfinite(t[0]) || !isfinite(t[1]) || !isfinite(t[2]) || size > 1e9 || t[0] <= 0 || t[2] <= 0)
        return vector(1, 0, 1);
    vector bounded = clamp(t, vector(-1e6), vector(1e6));
    // Eigenvalues of C = T^t T are the squared principal stretches.
    float cxx = bounded[0] * bounded[0];
    float cxy = bounded[0] * bounded[1];
    float cyy = bounded[1] * bounded[1] + bounded[2] * bounded[2];
    area = bounded[0] * bounded[2];
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
