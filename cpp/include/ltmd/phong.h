// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltmd/any_distribution.h"
#include "ltmd/std_distribution.h"

namespace ltmd::inline v0 {

/// The Phong distribution D = (n + 2) / (2 pi) cos^n(theta): the STD of alpha = sqrt(2 / (n + 2))
/// and gamma = n / 2 + 2, and so exactly masked.
template <std::floating_point R>
class Phong : public STD<R> {
public:
    /// Throws InvalidInput unless the exponent n is in [0, 1e9].
    explicit Phong(double exponent)
        : STD<R>(std::sqrt(2 / (require_range("exponent", exponent, 0, 1e9) + 2)),
                 exponent / 2 + 2),
          exponent_(exponent) {}

    double exponent() const { return exponent_; }

private:
    double exponent_;
};

extern template LTMD_API AnyDistribution<float>::AnyDistribution(Phong<float>);
extern template LTMD_API AnyDistribution<double>::AnyDistribution(Phong<double>);

}  // namespace ltmd::inline v0
