// SPDX-License-Identifier: Apache-2.0
#pragma once

// Random microfacets of exact distributions under the map of the surface, for closures of their
// own: reflection(m) and refraction(m, eta). What no closure has (GTR, STD, sheen, V-cavities,
// ellipsoids, refraction under M) renders so, without light sampling and with plain noise.
//
// All happens at rest, where the distribution is isotropic. A map M of the surface takes the normal
// (q, 1), q its negative slope, to (M^-t q, 1) and the view at rest (s, z) to (M s, z), so the
// products of both stay. Of M two vectors are used: a = M^-t X and b = M^-t Y.

#include "ltmd_surface.h"

#define LTMD_GTR 0
#define LTMD_BECKMANN 1
#define LTMD_STD 2
#define LTMD_SHEEN 3
#define LTMD_ELLIPSOID 4

#define LTMD_HEIGHT_CORRELATED 0
#define LTMD_SEPARABLE 1
#define LTMD_V_CAVITY 2

struct LtmdDistribution {
    int kind;
    float alpha2;
    float gamma;
    float scale;  // of the density
    float decay;  // the density of log(slope) falls as slope^-(decay + 1); 0: faster than any power
    // Of an ellipsoid: K, upper triangular, and minus the mean slope.
    float kxx, kxy, kyy, mean_x, mean_y;
};

// GTR (microsurface-transformations, eq. 32), Beckmann, STD (gamma > 1.5) or sheen.
LtmdDistribution ltmd_distribution(int kind, float alpha, float gamma)
{
    float a = clamp(alpha, 1e-4, 1.0);
    LtmdDistribution d = { kind, a * a, gamma, 1, 1, 0, 0, 0, 0, 0 };
    if (kind == LTMD_GTR) {
        d.gamma = clamp(gamma, 0.0, 4.0);
        float log_alpha2 = log(d.alpha2), y = (1 - d.gamma) * log_alpha2;
        d.scale = a < 1 ? (1 - d.alpha2) / -log_alpha2 : 1;
        d.scale *= 2 * (abs(y) < 1e-4 ? 1 - y / 2 : y / expm1(y));
    } else if (kind == LTMD_BECKMANN) {
        d.decay = 0;
    } else if (kind == LTMD_STD) {
        d.gamma = clamp(gamma, 1.6, 100.0);
        d.decay = 2 * d.gamma - 3;
    } else {
        d.gamma = 1 / max(a, 0.02);
        d.scale = 2 + d.gamma;
    }
    return d;
}

// The ellipsoid |A p| = 1 with A = diag(alpha_x, alpha_y, 1) R_x R_y R_z (ellipsoid-ndf, eq. 2, 3):
// Q A / |A n| = [[K, 0], [-mean_slope, 1]] with Q orthogonal.
LtmdDistribution ltmd_ellipsoid(float alpha_x, float alpha_y, vector theta)
{
    float cx = cos(theta[0]), sx = sin(theta[0]);
    float cy = cos(theta[1]), sy = sin(theta[1]);
    float cz = cos(theta[2]), sz = sin(theta[2]);
    float ax = clamp(alpha_x, 1e-3, 1e3), ay = clamp(alpha_y, 1e-3, 1e3);
    // Columns of A.
    vector x = vector(ax * cy * cz, ay * (sx * sy * cz + cx * sz), sx * sz - cx * sy * cz);
    vector y = vector(-ax * cy * sz, ay * (cx * cz - sx * sy * sz), cx * sy * sz + sx * cz);
    vector z = vector(ax * sy, -ay * sx * cy, cx * cy);
    float size = length(z);
    LtmdDistribution d = { LTMD_ELLIPSOID, 1, 2, 1, 1, 0, 0, 0, 0, 0 };
    d.mean_x = dot(x, z) / (size * size);
    d.mean_y = dot(y, z) / (size * size);
    vector u = (x - d.mean_x * z) / size, v = (y - d.mean_y * z) / size;
    d.kxx = length(u);
    d.kxy = dot(u, v) / d.kxx;
    d.kyy = length(cross(u, v)) / d.kxx;
    return d;
}

// Density of the logarithm of the slope r where t = r^2: 2 pi t P22.
float ltmd_density(LtmdDistribution d, float t)
{
    float p;
    if (d.kind == LTMD_GTR)
        p = d.scale * t * exp((d.gamma - 2) * log(1 + t) - d.gamma * log(t + d.alpha2));
    else if (d.kind == LTMD_BECKMANN)
        p = 2 * t / d.alpha2 * exp(-t / d.alpha2);
    else if (d.kind == LTMD_STD)
        p = 2 * t / d.alpha2 * exp(-d.gamma * log(1 + t / ((d.gamma - 1) * d.alpha2)));
    else
        p = d.scale * t / ((1 + t) * (1 + t)) * exp(-d.gamma / 2 * log(1 + 1 / t));
    return p;
}

// The slope r that a share u of the normals' projections stays below.
float ltmd_slope(LtmdDistribution d, float u)
{
    float t;
    if (d.kind == LTMD_BECKMANN) {
        t = -d.alpha2 * log(1 + -u);
    } else if (d.kind == LTMD_STD) {
        t = (d.gamma - 1) * d.alpha2 * expm1(-log(1 + -u) / (d.gamma - 1));
    } else {
        float sine2 = u;
        if (d.kind == LTMD_SHEEN) {
            sine2 = pow(u, 2 / (2 + d.gamma));
        } else if (d.alpha2 < 1) {
            // microsurface-transformations, eq. 33, solved for the sine.
            float most = -log(d.alpha2);
            float e = u * most;
            if (abs(d.gamma - 1) > 1e-4)
                e = -log(1 + u * expm1((d.gamma - 1) * log(d.alpha2))) / (d.gamma - 1);
            sine2 = d.alpha2 / (1 - d.alpha2) * expm1(min(e, most));
        }
        t = sine2 / max(1 - sine2, 1e-7);
    }
    return sqrt(t);
}

// Lambda at a view of this tangent is the mean over the slopes r of hidden(r tangent): what the
// microfacets of slope r show to the view, of all azimuths together, beyond their projected area.
float ltmd_hidden(float x)
{
    return x > 1 ? (sqrt((x - 1) * (x + 1)) - acos(1 / x)) / M_PI : 0;
}

// It is integrated by w with r tangent = cosh(w), where the integrand is smooth and even: the
// trapezoidal rule converges geometrically. Beyond w_end the slopes' density is a power.
#define LTMD_LAMBDA_STEP 0.35
#define LTMD_LAMBDA_STEPS 48

float ltmd_lambda_term(LtmdDistribution d, float tangent, float w)
{
    float x = cosh(w), r = x / tangent;
    return ltmd_density(d, r * r) * ltmd_hidden(x) * tanh(w);
}

// Adds terms until the sum is over `stop`; `step` is the last one, of the value `term`.
float ltmd_lambda_sum(LtmdDistribution d, float tangent, float stop, output int step,
                      output float term)
{
    float sum = 0;
    int steps = min((int)(log(60 * (1 + tangent)) / LTMD_LAMBDA_STEP) + 1, LTMD_LAMBDA_STEPS);
    term = 0;
    step = 0;
    while (step < steps && sum <= stop) {
        step += 1;
        term = ltmd_lambda_term(d, tangent, step * LTMD_LAMBDA_STEP);
        sum += term * LTMD_LAMBDA_STEP;
    }
    return sum;
}

// The difference to Lambda after the last step.
float ltmd_lambda_rest(LtmdDistribution d, float tangent, int step, float term)
{
    float rest = -term * LTMD_LAMBDA_STEP / 2;
    if (d.decay > 0) {
        float x = cosh(step * LTMD_LAMBDA_STEP), r = x / tangent;
        rest += ltmd_density(d, r * r) * (x / (M_PI * d.decay) - 0.5 / (d.decay + 1));
    }
    return rest;
}

// A view in the space where the ellipsoid is a sphere, and what it sees of the half that faces the
// macrosurface (ellipsoid-ndf, eq. 28).
vector ltmd_to_sphere(LtmdDistribution d, vector v)
{
    return vector(d.kxx * v[0] + d.kxy * v[1], d.kyy * v[1],
                  v[2] + d.mean_x * v[0] + d.mean_y * v[1]);
}
float ltmd_lune_area(vector w, float size)
{
    return w[2] > 0 ? (size + w[2]) / 2 : (w[0] * w[0] + w[1] * w[1]) / (2 * (size - w[2]));
}

// Smith's Lambda of a view at rest, v[2] > 0.
float ltmd_lambda(LtmdDistribution d, vector v)
{
    float lambda = 0;
    float tangent = hypot(v[0], v[1]) / v[2];
    if (d.kind == LTMD_ELLIPSOID) {
        vector w = ltmd_to_sphere(d, v);
        lambda = max(0.0, ltmd_lune_area(w, length(w)) / v[2] - 1);  // eq. 6
    } else if (tangent > 1e-4) {
        int step;
        float term;
        lambda = ltmd_lambda_sum(d, tangent, 1e30, step, term);
        lambda += ltmd_lambda_rest(d, tangent, step, term);
    }
    return lambda;
}

// A random number in [0, 1): P is another for every sample, and at every bounce of its path.
float ltmd_random(float key)
{
    return hashnoise(P, key);
}

// The azimuth from the view's of a microfacet whose share is max(0, 1 + x cos(azimuth)).
float ltmd_visible_azimuth(float x, float key)
{
    float azimuth, shown, both;
    int tries = 0;
    // Of the pair at an azimuth and opposite to it one is seen, or both.
    do {
        float k = key + 3 * tries;
        azimuth = M_2PI * ltmd_random(k);
        shown = x * cos(azimuth);
        both = max(2.0, 1 + abs(shown));
        if (ltmd_random(k + 1) * both > 1 + shown)
            azimuth += M_PI;
        tries += 1;
    } while (tries < 20 && ltmd_random(key + 3 * tries - 1) * max(2.0, 1 + x) > both);
    return azimuth;
}

// A point of the half ellipsoid seen from v, as the normal (q, 1) (ellipsoid-ndf, section 4.1).
vector ltmd_ellipsoid_normal(LtmdDistribution d, vector v, float key)
{
    // (a) A point on the unit disk.
    float radius = sqrt(ltmd_random(key)), phi = M_2PI * ltmd_random(key + 1);
    float disk_x = radius * cos(phi), disk_y = radius * sin(phi);
    // (b) The disk compressed to what the lune projects to.
    vector w = ltmd_to_sphere(d, v);
    float size = length(w), across = hypot(w[0], w[1]);
    float cosine = w[2] / size, sine = across / size;
    float s = ltmd_lune_area(w, size) / size;
    float half_chord = sqrt(max(0.0, 1 - disk_y * disk_y));
    float x = s * disk_x + (1 - s) * half_chord;
    float z = sqrt(max(0.0, (half_chord - x) * (half_chord + x)));
    // (c) Turned to w and the macrosurface normal.
    float c = across > 0 ? w[0] / across : 1, o = across > 0 ? w[1] / across : 0;
    float radial = z * sine - x * cosine;
    float up = max(x * sine + z * cosine, 1e-6);
    // (d) Back to the ellipsoid, and its normal there.
    float px = (radial * c + disk_y * (-o)) / up, py = (radial * o + disk_y * c) / up;
    return vector(d.kxx * px + d.mean_x, d.kxy * px + d.kyy * py + d.mean_y, 1);
}

// A random normal (q, 1) at rest that faces the view v. `facing`: the projected area that faces v,
// per area of the macrosurface, of such normals over their share of those drawn; 1 + Lambda or
// little else.
vector ltmd_facing_normal(LtmdDistribution d, int masking, vector v, float key, output float facing)
{
    vector q;
    float across = hypot(v[0], v[1]), tangent = across / v[2];
    if (d.kind == LTMD_ELLIPSOID) {
        vector w = ltmd_to_sphere(d, v);
        facing = ltmd_lune_area(w, length(w)) / v[2];
        q = ltmd_ellipsoid_normal(d, v, key);
    } else {
        float u = ltmd_random(key), r, azimuth;
        if (masking == LTMD_V_CAVITY) {
            // Both facets of a groove, drawn from D, by their projected areas.
            r = ltmd_slope(d, u);
            azimuth = M_2PI * ltmd_random(key + 1);
            float shown = r * tangent * cos(azimuth);
            facing = max(1.0, (1 + abs(shown)) / 2);
            if (ltmd_random(key + 2) * 2 * facing > 1 + shown)
                azimuth += M_PI;
        } else {
            // The slope's density is p (1 + hidden), drawn from p, from the steps of Lambda and
            // from the power beyond them.
            int step = 0;
            float term, steps_sum = 0, tail = 0, edge = 1;
            if (tangent > 1e-4) {
                steps_sum = ltmd_lambda_sum(d, tangent, 1e30, step, term);
                edge = cosh((step + 0.5) * LTMD_LAMBDA_STEP);
                if (d.decay > 0)
                    tail = ltmd_density(d, edge * edge / (tangent * tangent)) * edge /
                           (M_PI * d.decay);
            }
            float part = (1 + steps_sum + tail) * ltmd_random(key + 1);
            float x;
            if (part < 1) {
                x = ltmd_slope(d, u) * tangent;
            } else if (part < 1 + steps_sum) {
                ltmd_lambda_sum(d, tangent, part - 1, step, term);
                x = cosh((step - 0.5 + u) * LTMD_LAMBDA_STEP);
            } else {
                x = edge * min(pow(1 - u, -1 / d.decay), 1e12);
            }
            r = tangent > 1e-4 ? x / tangent : ltmd_slope(d, u);
            float p = ltmd_density(d, r * r), drawn = p;
            if (x > edge) {
                drawn += tail * d.decay * pow(x / edge, -d.decay);
            } else if (x > 1) {
                float w = log(x + sqrt((x - 1) * (x + 1)));
                step = (int)(w / LTMD_LAMBDA_STEP + 0.5);
                if (step > 0)
                    drawn += ltmd_lambda_term(d, tangent, step * LTMD_LAMBDA_STEP) / tanh(w);
            }
            facing = 1 + steps_sum + tail;
            if (drawn > 0)
                facing *= p * (1 + ltmd_hidden(x)) / drawn;
            azimuth = ltmd_visible_azimuth(r * tangent, key + 2);
        }
        float c = across > 0 ? v[0] / across : 1, s = across > 0 ? v[1] / across : 0;
        float x = r * cos(azimuth), y = r * sin(azimuth);
        q = vector(x * c - y * s, x * s + y * c, 1);
    }
    return q;
}

// Euler's beta function for p, q >= 1: recurrences, then Stirling's series.
float ltmd_beta(float p_from, float q_from)
{
    float p = p_from, q = q_from, logarithm = 0;
    while (p < 6) {
        logarithm += log(1 + q / p);
        p += 1;
    }
    while (q < 6) {
        logarithm += log(1 + p / q);
        q += 1;
    }
    logarithm += (1 / p + 1 / q - 1 / (p + q)) / 12 - (p - 0.5) * log(1 + q / p) - q * log(1 + p / q);
    return sqrt(M_2PI / q) * exp(logarithm);
}

// What the view v and the light o see together of the normals (q, 1): o below the surface sees
// their other side (masking-shadowing, eq. 49, 98, 99; see masking.h for the two sides).
float ltmd_masking(LtmdDistribution d, int masking, vector v, vector o, vector q)
{
    vector upper = o[2] < 0 ? -o : o;
    float g = 0;
    if (v[2] > 0 && upper[2] > 0) {
        if (masking == LTMD_V_CAVITY && d.kind != LTMD_ELLIPSOID) {
            float g_v = min(1.0, 2 * v[2] / max(dot(v, q), 1e-9));
            float g_o = min(1.0, 2 * upper[2] / max(dot(upper, q), 1e-9));
            g = o[2] < 0 ? max(0.0, g_v + g_o - 1) : min(g_v, g_o);
        } else {
            float lambda_v = ltmd_lambda(d, v), lambda_o = ltmd_lambda(d, upper);
            if (masking == LTMD_SEPARABLE)
                g = 1 / ((1 + lambda_v) * (1 + lambda_o));
            else
                g = o[2] < 0 ? ltmd_beta(1 + lambda_v, 1 + lambda_o) : 1 / (1 + lambda_v + lambda_o);
        }
    }
    return g;
}

// The map of the surface as the vectors a and b.
struct LtmdFacets {
    normal shading;  // towards the viewer
    vector a;
    vector b;
};

LtmdFacets ltmd_facets(normal shading, vector a, vector b)
{
    // Behind its own shading normal a surface shows as it is.
    LtmdFacets facets = { dot(shading, I) > 0 ? shading : Ng, a, b };
    return facets;
}

// A direction at rest.
vector ltmd_at_rest(LtmdFacets facets, vector v)
{
    return vector(dot(v, facets.a), dot(v, facets.b), dot(v, facets.shading));
}

// A random microfacet towards the viewer: q at rest, m of the surface.
normal ltmd_random_normal(LtmdFacets facets, LtmdDistribution d, int masking, output vector q,
                          output float facing)
{
    // Two materials of one surface differ.
    float key = 1e3 * hashnoise(d.alpha2, d.gamma + d.kind);
    q = ltmd_facing_normal(d, masking, ltmd_at_rest(facets, I), (int)key + time, facing);
    return normalize((normal)(q[0] * facets.a + q[1] * facets.b) + facets.shading);
}

// The weight without F of reflection(m), or of refraction into the direction `other` where `side`
// is -1.
float ltmd_facet_weight(LtmdFacets facets, LtmdDistribution d, int masking, vector q, float facing,
                        vector other, int side)
{
    vector o = ltmd_at_rest(facets, other);
    // A direction must be on its side of the shading and of the true surface.
    float weight = 0;
    if (side * o[2] > 0 && side * dot(Ng, other) > 0)
        weight = facing * ltmd_masking(d, masking, ltmd_at_rest(facets, I), o, q);
    return weight;
}

// A random visible normal m of GTR under the map of the surface, with the weight for
// `weight * F * reflection(m)`. Returns 0 where there is none.
int ltmd_reference_normal(LtmdSurface surface, float alpha, float gamma, output normal m,
                          output float weight)
{
    vector X = surface.scale_x == surface.scale_y ? ltmd_frame_x(vector(0), surface.shading)
                                                  : surface.smooth;
    LtmdFacets facets = ltmd_facets(surface.shading, surface.scale_x * X,
                                    surface.scale_y * cross(surface.shading, X));
    LtmdDistribution d = ltmd_distribution(LTMD_GTR, alpha, gamma);
    vector q;
    float facing;
    m = ltmd_random_normal(facets, d, LTMD_HEIGHT_CORRELATED, q, facing);
    weight = ltmd_facet_weight(facets, d, LTMD_HEIGHT_CORRELATED, q, facing,
                               2 * dot(I, m) * m - I, 1);
    return weight > 0;
}
