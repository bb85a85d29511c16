// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "ltmd/export.h"
#include "ltmd/unit_mdf.h"

/// Which value of one distribution's roughness parameter looks most like a value of another's
/// (microfacet-distribution-conversion). Distributions are compared in unit form, as functions of
/// the angle beta from the normal, with Beckmann's as the reference: two values correspond if they
/// correspond to the same m_B. So conversions there and back give the same number.
namespace ltmd::inline v0 {

/// What "most like" means; written as in mdf_method_names.
enum class MdfMethod {
    /// The least root mean square difference from Beckmann's unit form over beta in
    /// [0, min(4 m_B, pi/2)] (the fits of Table 2).
    rmse,
    /// Unit forms that fall to 1/2 at the same angle (Blinn; eq. 3-10).
    half_angle,
    /// The paper's formulas for rmse: eq. 12-15, Tables 3 and 4; for its parameters and range, m_B
    /// up to 0.45, where they are within 2.5 % of rmse. Schlick's m is m_B.
    closed_form,
    /// Ward's m_B^2 N = 2, between Beckmann and Blinn-Phong (eq. 11).
    ward,
};
inline constexpr std::array<const char*, 4> mdf_method_names{"rmse", "half_angle", "closed_form",
                                                             "ward"};

/// The method of a name; throws InvalidInput with the list of names for any other.
LTMD_API MdfMethod parse_mdf_method(std::string_view name);

/// A conversion from one parameter to another, for many values. The tables of rmse are exact to
/// 1e-10 and made once; those of gtr_alpha with a gamma other than 2 each time, in milliseconds.
///
/// Values whose m_B is in [1e-6, 1] are converted, as far as the result is in its range too; above
/// m_B = 1/sqrt(2), where Beckmann's unit form has its peak off the normal, they match ever less.
/// Between parameters of one distribution (blender_roughness and ggx_alpha, the two exponents of
/// cos^N) every method is exact. Anisotropic distributions: an axis at a time, (N_x, N_y) to
/// (alpha_x, alpha_y).
class LTMD_API MdfConversion {
public:
    /// gamma: of gtr_alpha, in [0.5, 16], else unused. Throws InvalidInput if the method has no
    /// conversion between these parameters, or for another gamma.
    MdfConversion(MdfParameter source, MdfParameter target, MdfMethod method = MdfMethod::rmse,
                  double gamma = 2);

    /// Throws InvalidInput for a value outside [low(), high()].
    double operator()(double value) const;
    /// The same for arrays of one length, on thread_count() threads; the first such value is named.
    void operator()(std::span<const double> values, std::span<double> out) const;

    double low() const { return low_; }
    double high() const { return high_; }

private:
    MdfParameter source_, target_;
    MdfMethod method_;
    double low_, high_;
    std::function<double(double)> convert_;
};

/// The value of a parameter whose unit form is nearest to another's, and how near.
struct MdfFit {
    double value;
    double rmse;  ///< Root of the mean over the angles of the squared difference.
};

/// The `target`, in its range, whose unit form is nearest to that of `source` = `value` over beta
/// in [0, largest_angle]: Table 2 with Beckmann as source. Throws InvalidInput for a value or gamma
/// outside its range, or an angle that is not in (0, pi/2].
LTMD_API MdfFit fit_mdf(MdfParameter source, double value, MdfParameter target,
                        double largest_angle, double gamma = 2);

}  // namespace ltmd::inline v0
