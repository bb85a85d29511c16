// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltmd/export.h"

/// Smith's masking of slope distributions of one's own, by quadrature to 1e-11 or so.
namespace ltmd::inline v0 {

/// Smith's Lambda of a surface whose slopes along the view's azimuth have the density
/// `slopes`(slope), which integrates to 1 over all slopes: the integral of (x - c) slopes(x) over
/// x > c, over c, with c > 0 the cotangent of the view's angle from the normal (masking-shadowing,
/// eq. 124). Throws InvalidInput for another c and where the integral does not converge.
LTMD_API double smith_lambda(const std::function<double(double)>& slopes, double cotangent);

/// Smith's Lambda of every distribution of one shape, P22 = f(|slope| / alpha) / alpha^2, also
/// stretched: f is the density of slopes for alpha = 1, and a = 1 / (alpha_o tan theta_o) > 0 with
/// alpha_o the roughness projected onto the view's azimuth (masking-shadowing, eq. 65, 79, 80, 93).
/// Throws as above.
LTMD_API double smith_lambda_of_shape(const std::function<double(double)>& shape, double a);

/// The integral of f(|slope|) over all slopes: 1/c in the notation of masking-shadowing, eq. 87,
/// whose f takes the square of |slope|. Throws InvalidInput where it does not converge.
LTMD_API double shape_integral(const std::function<double(double)>& shape);

}  // namespace ltmd::inline v0
