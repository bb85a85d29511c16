// SPDX-License-Identifier: Apache-2.0
#pragma once

// GTR as few GGX and Beckmann lobes, each of which a closure renders; and their masking under the
// linear map of the surface.
//
// Everything is written out per lobe, in scalars that are assigned once, without loops and early
// returns: so the renderer folds the fit into constants wherever Roughness and Tail are not
// textured, and drops unused lobes.

#include "ltmd_energy.h"
#include "ltmd_lobe_table.h"
#include "ltmd_surface.h"

// All tables in a row, gamma <= 2 with 1 to 6 lobes, then beyond. It is the default value of a
// shader's parameter: a local array would be filled at every call.
#define LTMD_LOBE_TABLE                                                                           \
    LTMD_LOBE_TABLE_TO_2_1, LTMD_LOBE_TABLE_TO_2_2, LTMD_LOBE_TABLE_TO_2_3,                       \
    LTMD_LOBE_TABLE_TO_2_4, LTMD_LOBE_TABLE_TO_2_5, LTMD_LOBE_TABLE_TO_2_6,                       \
    LTMD_LOBE_TABLE_TO_4_1, LTMD_LOBE_TABLE_TO_4_2, LTMD_LOBE_TABLE_TO_4_3,                       \
    LTMD_LOBE_TABLE_TO_4_4, LTMD_LOBE_TABLE_TO_4_5, LTMD_LOBE_TABLE_TO_4_6
// Place and weight at each alpha and gamma, of one lobe.
#define LTMD_LOBE_TABLE_LOBE                                                                      \
    (2 * (LTMD_LOBE_TABLE_ALPHA_STEPS + 1) * (LTMD_LOBE_TABLE_GAMMA_STEPS + 1))
// 42 of them. OSL wants a plain number.
#define LTMD_LOBE_TABLE_SIZE 12852

// A closure whose weight is below this vanishes in Cycles.
#define LTMD_LEAST_WEIGHT 1e-5

// Lobes at rest; unused ones have weight 0. The first `ggx` are GGX, the others Beckmann.
struct LtmdLobes {
    int ggx;
    float alpha0, alpha1, alpha2, alpha3, alpha4, alpha5;
    float weight0, weight1, weight2, weight3, weight4, weight5;
    float gain;  // 1 / albedo of all closures together, if it is wanted
};

// Calls STEP(number) for each lobe.
#define LTMD_EACH_LOBE(STEP) STEP(0) STEP(1) STEP(2) STEP(3) STEP(4) STEP(5)

// Alpha of the material from its inputs.
float ltmd_alpha(float roughness, int is_alpha)
{
    float r = clamp(roughness, 0.0, 1.0);
    return is_alpha ? r : r * r;
}

// How many lobes: at most `most` where Lobes is 0.
int ltmd_lobe_count(int lobes, float alpha, float gamma, int most)
{
    int count = lobes;
    if (lobes <= 0)
        count = gamma <= 2 && alpha >= 0.1 ? 3 : most;
    return clamp(count, 1, 6);
}

// Weights of Lagrange's cubic through four neighbours at 0, 1, 2, 3.
void ltmd_cubic(float t, output float a0, output float a1, output float a2, output float a3)
{
    a0 = -(t - 1) * (t - 2) * (t - 3) / 6;
    a1 = t * (t - 2) * (t - 3) / 2;
    a2 = -t * (t - 1) * (t - 3) / 2;
    a3 = t * (t - 1) * (t - 2) / 6;
}

float ltmd_cubic_at(float table[], int at, int step, float a0, float a1, float a2, float a3)
{
    return a0 * table[at] + a1 * table[at + step] + a2 * table[at + 2 * step] +
           a3 * table[at + 3 * step];
}

// GTR of the given alpha and gamma (0 to 4) as `count` lobes, with weights that add up to 1: the
// fit of ltmd.fit_lobes, continuous in alpha and gamma. Below alpha = 1e-4 the fit is that of 1e-4.
void ltmd_fit_lobes(float table[], float alpha, float unbounded_gamma, int count,
                    output LtmdLobes lobes)
{
    float gamma = clamp(unbounded_gamma, 0.0, 4.0);
    int beyond = gamma > 2;
    // A GGX lobe, whatever the count.
    int single = (gamma == 2) + (alpha >= 1);
    int n = single ? 1 : count;
    float log_alpha2 = 2 * log(max(alpha, 1e-4));
    float most = -2 * log(1e-4);
    float x = beyond ? -log_alpha2 / (3 - log_alpha2) * (most + 3) / most : -log_alpha2 / most;
    x *= LTMD_LOBE_TABLE_ALPHA_STEPS;
    float y = 4 * (gamma - (beyond ? 2 : 0));
    int first_x = clamp((int)x - 1, 0, LTMD_LOBE_TABLE_ALPHA_STEPS - 3);
    int first_y = clamp((int)y - 1, 0, LTMD_LOBE_TABLE_GAMMA_STEPS - 3);
    float a0, a1, a2, a3, g0, g1, g2, g3;
    ltmd_cubic(x - first_x, a0, a1, a2, a3);
    ltmd_cubic(y - first_y, g0, g1, g2, g3);
    int column = 2 * n;
    int row = (LTMD_LOBE_TABLE_GAMMA_STEPS + 1) * column;
    int start = LTMD_LOBE_TABLE_LOBE * ((beyond ? 21 : 0) + n * (n - 1) / 2) + first_x * row +
                first_y * column;
    // How the weights vanish at the borders.
    float first_factor = !beyond && n > 1 ? 2 - gamma : 1.0;
    float last_factor = beyond ? (gamma - 2) * (1 - alpha) * (1 + alpha) : gamma;
    float inner_factor = beyond ? last_factor : last_factor * (2 - gamma);

#define LTMD_TABLE_ROW(at) ltmd_cubic_at(table, at, column, g0, g1, g2, g3)
#define LTMD_TABLE_VALUE(at)                                                                      \
    (a0 * LTMD_TABLE_ROW(at) + a1 * LTMD_TABLE_ROW(at + row) +                                    \
     a2 * LTMD_TABLE_ROW(at + 2 * row) + a3 * LTMD_TABLE_ROW(at + 3 * row))
#define LTMD_FIT_LOBE(i)                                                                          \
    float share##i = 0;                                                                           \
    lobes.alpha##i = 0;                                                                           \
    if (i < n && !single) {                                                                       \
        float place = LTMD_TABLE_VALUE(start + i);                                                \
        share##i = exp(LTMD_TABLE_VALUE(start + n + i)) *                                         \
                   (i == 0 ? first_factor : (i + 1 < n ? inner_factor : last_factor));            \
        lobes.alpha##i = exp((beyond ? log_alpha2 + place                                         \
                                     : log_alpha2 * clamp(place, 0.0, 1.0)) / 2);                 \
    }
    LTMD_EACH_LOBE(LTMD_FIT_LOBE)
    if (single) {
        share0 = 1;
        lobes.alpha0 = alpha;
    }
    lobes.ggx = beyond ? 1 : 6;
#define LTMD_NORMALISE_LOBE(i) lobes.weight##i = share##i * inverse;
    float inverse = 1 / (share0 + share1 + share2 + share3 + share4 + share5);
    LTMD_EACH_LOBE(LTMD_NORMALISE_LOBE)
}

// 2 v_z (1 + Lambda(v)) of a GGX lobe; across = alpha tan(theta) v_z.
float ltmd_ggx_area(float z, float across)
{
    return z + hypot(z, across);
}

// The same of a Beckmann lobe, by the rational fit that Cycles' closure uses (masking-shadowing,
// eq. 69): so the sum of closures passes the weak white furnace as well as a single one.
float ltmd_beckmann_area(float z, float across)
{
    float a = min(z / max(across, 1e-9), 1.6);
    return 2 * z + 2 * across * (1 - 1.259 * a + 0.396 * a * a) / (3.535 + 2.181 * a);
}

// Turns the weights, shares of the slope distribution, into shares of the area that is visible from
// the viewer: w_i (1 + Lambda_i) / (1 + Lambda), with Smith's Lambda = sum of w_i Lambda_i.
void ltmd_visible_weights(LtmdSurface surface, output LtmdLobes lobes)
{
    float z, across;
    ltmd_view(surface, z, across);
#define LTMD_VISIBLE_LOBE(i)                                                                      \
    float share##i = 0;                                                                           \
    if (lobes.weight##i > 0)                                                                      \
        share##i = lobes.weight##i *                                                              \
                   (i < lobes.ggx ? ltmd_ggx_area(z, lobes.alpha##i * across)                     \
                                  : ltmd_beckmann_area(z, lobes.alpha##i * across));
    LTMD_EACH_LOBE(LTMD_VISIBLE_LOBE)
    float inverse = 1 / (share0 + share1 + share2 + share3 + share4 + share5);
    LTMD_EACH_LOBE(LTMD_NORMALISE_LOBE)
}

// Scales the weights of lobes rougher than closures can be to the energy of those lobes; with all
// energy preserved they stay, as their closures may be as bright as they are. Sets the gain.
void ltmd_lobe_energy(LtmdSurface surface, float preserve_energy, output LtmdLobes lobes)
{
    lobes.gain = 1;
    float roughest = 0;
    // Lobes of less weight change nothing that is seen.
#define LTMD_ROUGHEST(i)                                                                          \
    if (lobes.weight##i > 0.01)                                                                   \
        roughest = max(roughest, lobes.alpha##i);
    LTMD_EACH_LOBE(LTMD_ROUGHEST)
    if (preserve_energy > 0 || roughest * surface.scale_y > 1) {
        // A loop, as functions are copied to where they are called.
        float alphas[6] = { lobes.alpha0, lobes.alpha1, lobes.alpha2,
                            lobes.alpha3, lobes.alpha4, lobes.alpha5 };
        float weights[6] = { lobes.weight0, lobes.weight1, lobes.weight2,
                             lobes.weight3, lobes.weight4, lobes.weight5 };
        float albedo = 0;
        for (int i = 0; i < 6; i += 1) {
            int rough = weights[i] > 0.01 && alphas[i] * surface.scale_y > 1;
            if (weights[i] > 0 && (rough || preserve_energy > 0)) {
                float gain = ltmd_closure_gain(i < lobes.ggx, surface, alphas[i]);
                albedo += weights[i] / gain;
                if (rough && preserve_energy < 1) {
                    // The noise of a faint lobe is not seen.
                    int pairs = clamp((int)(1 + 16 * weights[i]), 2, 8);
                    float part = ltmd_random_albedo(i < lobes.ggx, surface, alphas[i], pairs);
                    weights[i] *= mix(part * gain, 1.0, max(preserve_energy, 0.0));
                }
            }
        }
        if (preserve_energy > 0)
            lobes.gain = 1 / albedo;
        lobes.weight0 = weights[0];
        lobes.weight1 = weights[1];
        lobes.weight2 = weights[2];
        lobes.weight3 = weights[3];
        lobes.weight4 = weights[4];
        lobes.weight5 = weights[5];
    }
}

// One of the lobes, with its share of the weights as probability, in the place of all.
void ltmd_pick_lobe(output LtmdLobes lobes)
{
    // P is another for each camera sample and each bounce.
    float sum = lobes.weight0 + lobes.weight1 + lobes.weight2 + lobes.weight3 + lobes.weight4 +
                lobes.weight5;
    float u = sum * hashnoise(P, time);
    int picked = 0;
    float edge = lobes.weight0;
    float alpha = lobes.alpha0;
#define LTMD_PICK_LOBE(i)                                                                         \
    if (u >= edge && lobes.weight##i > 0) {                                                       \
        picked = i;                                                                               \
        alpha = lobes.alpha##i;                                                                   \
    }                                                                                             \
    edge += lobes.weight##i;
    LTMD_PICK_LOBE(1) LTMD_PICK_LOBE(2) LTMD_PICK_LOBE(3) LTMD_PICK_LOBE(4) LTMD_PICK_LOBE(5)
    lobes.ggx = picked < lobes.ggx;
    lobes.alpha0 = alpha;
    lobes.weight0 = sum;
    lobes.weight1 = 0;
    lobes.weight2 = 0;
    lobes.weight3 = 0;
    lobes.weight4 = 0;
    lobes.weight5 = 0;
}

// The lobes of a material, with their closures' weights; mode 1 leaves one of them. `most`: how many
// closures of its kind fit into the GPU's closure stack beside the rest of a material.
void ltmd_material_lobes(LtmdSurface surface, float table[], float alpha, float gamma,
                         int lobes_wanted, int mode, float preserve_energy, int most,
                         output LtmdLobes lobes)
{
    ltmd_fit_lobes(table, alpha, gamma, ltmd_lobe_count(lobes_wanted, alpha, gamma, most), lobes);
    int several = lobes.weight0 < 1;
    if (several)
        ltmd_visible_weights(surface, lobes);
    ltmd_lobe_energy(surface, preserve_energy, lobes);
    if (several && mode == 1)
        ltmd_pick_lobe(lobes);
}

// Arguments of a lobe's closure.
#define LTMD_LOBE_KIND(lobes, i) (i < lobes.ggx ? "ggx" : "beckmann")
#define LTMD_LOBE_ALPHAS(surface, lobes, i)                                                       \
    lobes.alpha##i * surface.scale_x, lobes.alpha##i * surface.scale_y
#define LTMD_LOBE_FRAME(surface, lobes, i)                                                        \
    surface.shading, surface.smooth, LTMD_LOBE_ALPHAS(surface, lobes, i)

// Adds the closure of lobe i. The renderer joins a closure with the color it is multiplied by, if
// that is ready; and the sum grows to the left, as its evaluation has a stack of limited depth.
#define LTMD_ADD_LOBE(sum, tint, lobes, i, CLOSURE)                                               \
    if (lobes.weight##i >= LTMD_LEAST_WEIGHT) {                                                   \
        color share = tint * lobes.weight##i;                                                     \
        sum = share * CLOSURE + sum;                                                              \
    }
