// SPDX-License-Identifier: Apache-2.0
// Reads baked tension and gives the lobe of the deformed surface: contract.md says what the numbers
// mean. GLSL 3.30. The image is a 32-bit float texture whose first row is the file's first (top) row.

vec3 ltmd_texel(sampler2D image, ivec2 at)
{
    return texelFetch(image, clamp(at, ivec2(0), textureSize(image, 0) - 1), 0).rgb;
}

// uv: within the image's tile, v up. Interpolated here as the filters of most GPUs have 8-bit weights.
vec3 ltmd_read_tension(sampler2D image, vec2 uv)
{
    vec2 p = vec2(uv.x, 1.0 - uv.y) * vec2(textureSize(image, 0)) - 0.5;
    ivec2 i = ivec2(floor(p));
    vec2 f = fract(p);
    vec3 t = mix(mix(ltmd_texel(image, i), ltmd_texel(image, i + ivec2(1, 0)), f.x),
                 mix(ltmd_texel(image, i + ivec2(0, 1)), ltmd_texel(image, i + ivec2(1, 1)), f.x), f.y);
    bool usable = !any(isnan(t)) && !any(isinf(t)) && t.x > 0.0 && t.z > 0.0;
    return usable ? t : vec3(1.0, 0.0, 1.0);
}

// alpha: the lobe at rest along U and V. m0: its columns say where the material's own anisotropy
// takes U and V; mat2(1.0) for none. Returns (alpha_x, alpha_y, angle), the smaller alpha first, at
// `angle` in [0, pi) from X = dP/du towards Y = N x X, N being the mesh's own normal.
vec3 ltmd_lobe(vec3 t, vec2 alpha, mat2 m0)
{
    mat2 m = mat2(t.x, 0.0, t.y, t.z) * m0;  // GLSL lists columns
    mat2 a = mat2(alpha.x, 0.0, 0.0, alpha.y) * inverse(m);  // Sigma' = a^T a
    float xx = dot(a[0], a[0]), xy = dot(a[0], a[1]), yy = dot(a[1], a[1]);
    float spread = length(vec2(0.5 * (xx - yy), xy));
    float largest = 0.5 * (xx + yy) + spread;
    float smallest = determinant(a) * determinant(a) / largest;
    if (spread <= 1e-6 * largest)
        return vec3(sqrt(largest), sqrt(largest), 0.0);
    const float pi = 3.14159265358979;
    return vec3(sqrt(smallest), sqrt(largest), mod(0.5 * (atan(2.0 * xy, xx - yy) + pi), pi));
}
