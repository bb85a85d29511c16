// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "ltmd/unit_mdf.h"

/// The unit forms by families: several parameters can belong to one (microfacet-distribution-
/// conversion, Table 1).
namespace ltmd::inline v0 {

enum class MdfFamily { beckmann, gauss, gtr, phong, schlick, sawicki };

struct UnitForm {
    MdfFamily family;
    double gamma;  ///< Of gtr, else unused.

    /// D(beta) / D(0) and its derivative by log(p).
    struct Point {
        double value, slope;
    };
    Point at(double p, double beta) const {
        if (!(std::abs(beta) < std::numbers::pi / 2)) return {0, 0};
        const double sine = std::sin(beta), cosine = std::cos(beta);
        // 1 - cos without its cancellation.
        const double half_sine = std::sin(beta / 2), versine = 2 * half_sine * half_sine;
        switch (family) {
            case MdfFamily::beckmann: {
                const double tangent = sine / (p * cosine), square = tangent * tangent;
                const double value = std::exp(-square - 4 * std::log(cosine));
                return {value, value > 0 ? 2 * square * value : 0};
            }
            case MdfFamily::gauss: {
                const double square = (beta / p) * (beta / p), value = std::exp(-square);
                return {value, value > 0 ? 2 * square * value : 0};
            }
            case MdfFamily::gtr: {
                const double square = (sine / p) * (sine / p);
                const double sum = cosine * cosine + square, value = std::pow(sum, -gamma);
                return {value, 2 * gamma * square / sum * value};
            }
            case MdfFamily::phong: {
                const double power = p * std::log1p(-versine), value = std::exp(power);
                return {value, value > 0 ? power * value : 0};
            }
            case MdfFamily::schlick: {
                // With y = x / m and q = 1 - y: m^2 y / (cos ((1 - y^2) + m y^2)^2).
                const double q = versine / p, y = 1 - q;
                if (y <= 0) return {0, 0};
                const double sum = q * (1 + y) + p * y * y;
                const double of_y = p * p / (cosine * sum * sum);
                const double sum_slope = y * (p * y + 2 * q * (p - 1));
                return {of_y * y, of_y * (2 * y + q - 2 * y * sum_slope / sum)};
            }
            case MdfFamily::sawicki: {
                const double sum = 1 + (p - 1) * versine / 4;
                const double value = cosine / (sum * sum * sum * sum);
                return {value, -p * versine / sum * value};
            }
        }
        return {0, 0};
    }

    /// The angle from which on the unit form is 0.
    double end(double p) const {
        return family == MdfFamily::schlick && p < 1 ? 2 * std::asin(std::sqrt(p / 2))
                                                     : std::numbers::pi / 2;
    }
};

/// The family of a parameter.
constexpr UnitForm unit_form(MdfParameter parameter, double gamma) {
    switch (parameter) {
        case MdfParameter::beckmann_alpha:
            return {MdfFamily::beckmann, 0};
        case MdfParameter::gauss_m:
            return {MdfFamily::gauss, 0};
        case MdfParameter::ggx_alpha:
        case MdfParameter::blender_roughness:
            return {MdfFamily::gtr, 2};
        case MdfParameter::gtr_alpha:
            return {MdfFamily::gtr, gamma};
        case MdfParameter::phong_exponent:
        case MdfParameter::ashikhmin_shirley_n:
            return {MdfFamily::phong, 0};
        case MdfParameter::schlick_m:
            return {MdfFamily::schlick, 0};
        case MdfParameter::sawicki_n:
            return {MdfFamily::sawicki, 0};
    }
    return {MdfFamily::beckmann, 0};
}

/// What a family's formula takes for the parameter's value, and back.
constexpr double family_value(MdfParameter parameter, double value) {
    return parameter == MdfParameter::blender_roughness ? value * value : value;
}
inline double parameter_value(MdfParameter parameter, double family_value) {
    return parameter == MdfParameter::blender_roughness ? std::sqrt(family_value) : family_value;
}

}  // namespace ltmd::inline v0
