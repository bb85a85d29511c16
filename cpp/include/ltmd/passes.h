// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "ltmd/export.h"
#include "ltmd/lobe_parameters.h"
#include "ltmd/tension.h"

/// What can be baked from tension t = (t11, t12, t22).
///
/// | pass      | R, G, B, A                                                  | at rest          |
/// |-----------|-------------------------------------------------------------|------------------|
/// | tension   | t11, t12, t22, 1                                            | 1, 0, 1          |
/// | stretch   | largest, smallest principal stretch, area ratio, 1          | 1, 1, 1          |
/// | wrinkle   | stretch along u, along v, shear angle (radians), 1          | 1, 1, 0          |
/// | alpha2    | sigma_xx, sigma_xy, sigma_yy of the lobe, 1                 | those of its M0  |
/// | roughness | alpha_x, alpha_y, cos 2 angle, sin 2 angle: A is data       | those of its M0  |
///
/// A pass is computed from the tension of each corner (or vertex, or triangle) and then
/// interpolated: alpha2 as a lobe's blend should be, roughness as an approximation of it.
namespace ltmd::inline v0 {

/// The names in the table, in its order.
LTMD_API std::span<const std::string> pass_names();

/// The channels that a pass computes: 4 for roughness, else 3 (A = 1 is added to files). Throws
/// InvalidInput for an unknown name.
LTMD_API int pass_channels(const std::string& pass);

/// Whether a pass depends on the lobe.
LTMD_API bool pass_uses_lobe(const std::string& pass);

/// A pass of each tension, [t.size() * pass_channels]; resizes `out`. Throws as pass_channels() and
/// alpha2().
LTMD_API void compute_pass(const std::string& pass, std::span<const Tension> t, const Lobe& lobe,
                           std::vector<float>& out);

/// The pass `wrinkle`: (stretch along u, stretch along v, shear angle) of each tension: |dP/du| and
/// |dP/dv| over those at rest, for a rest state with perpendicular u and v, and the angle in
/// radians by which they lean together, in (-pi/2, pi/2). Throws InvalidInput for another length of
/// `out`.
LTMD_API void wrinkle(std::span<const Tension> t, std::span<Vec3f> out);

}  // namespace ltmd::inline v0
