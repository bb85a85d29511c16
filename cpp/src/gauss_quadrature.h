// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

/// Gauss quadrature of any positive measure, by orthogonal polynomials.
namespace ltmd::inline v0 {

struct QuadratureNode {
    double x, weight;
};

/// The Gauss rule of at most `count` nodes for the measure that `points` samples (Stieltjes'
/// procedure; nodes by the QL algorithm, weights by Christoffel's formula). Fewer nodes where the
/// measure has no more points of support to the precision of a double.
std::vector<QuadratureNode> gauss_rule(std::span<const QuadratureNode> points, int count);

/// The Gauss-Jacobi rule on [0, 1] for the weight x^(a-1) (1 - x)^(b-1), a, b > 0.
std::vector<QuadratureNode> gauss_jacobi(int count, double a, double b);

}  // namespace ltmd::inline v0
