// SPDX-License-Identifier: Apache-2.0
#pragma once

// The mesh's own side of the surface. Cycles turns N and Ng towards the viewer on back faces, and
// outwards on mirrored objects; tension and material anisotropy belong to the side on which the
// triangle's corners run counter-clockwise. This is the one place that tells them apart: with the
// unflipped normal Y = n x X does not jump, so nothing else has a sign to change.
// pu, pv: the globals dPdu, dPdv (the triangle's edges; both negated on back faces); ng: Ng.
normal ltmd_mesh_side(normal n, vector pu, vector pv, normal ng)
{
    return dot(cross(pu, pv), ng) < 0 ? -n : n;
}

// X: tangent made orthogonal to n; any direction in the plane if the tangent gives none.
vector ltmd_frame_x(vector tangent, normal n)
{
    vector x = tangent - n * dot(n, tangent);
    if (!isfinite(dot(x, x)) || dot(x, x) <= 1e-12 * dot(tangent, tangent))
        x = cross(n, abs(n[0]) < 0.9 ? vector(1, 0, 0) : vector(0, 1, 0));
    return normalize(x);
}

// Unnormalised dP/du and dP/dv, times the same factor, from the screen derivatives of P and UV.
// Dividing by the determinant is left out: only directions and ratios are used. Returns 0 if the UV
// map has no area here (or there is none).
// Cycles negates the derivatives of attributes, not those of P, on back faces: eu, ev keep that sign.
int ltmd_uv_edges(vector px, vector py, vector ux, vector uy, output vector eu, output vector ev)
{
    float det = ux[0] * uy[1] - uy[0] * ux[1];
    float sign_of_det = det < 0 ? -1 : 1;
    eu = sign_of_det * (px * uy[1] - py * ux[1]);
    ev = sign_of_det * (py * ux[0] - px * uy[0]);
    float size = ux[0] * ux[0] + ux[1] * ux[1] + uy[0] * uy[0] + uy[1] * uy[1];
    return abs(det) > 1e-7 * size;
}

// dP/du of the UV map at this shading point as a unit vector, from the derivatives of P and UV; 0
// without a UV map. Exact on each triangle: the Tangent node's is averaged over each vertex, the
// frame of a tension is not.
vector ltmd_uv_tangent(vector dx_p, vector dy_p, vector dx_uv, vector dy_uv)
{
    float radius = length(dx_p);
    if (radius <= 0 || !isfinite(radius))
        return vector(0);
    vector eu, ev;
    if (!ltmd_uv_edges(dx_p / radius, dy_p / radius, dx_uv / radius, dy_uv / radius, eu, ev))
        return vector(0);
    return (backfacing() ? -1 : 1) * normalize(eu);
}
