// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "ltmd/export.h"

/// Microfacet distribution functions in unit form, D(beta) / D(0) with beta the angle between the
/// microfacet's and the macrosurface's normal (microfacet-distribution-conversion, Table 1).
namespace ltmd::inline v0 {

/// The numbers by which shading models state how rough a surface is. Each belongs to one family of
/// distributions; written as in mdf_parameters.
enum class MdfParameter {
    beckmann_alpha,       ///< m_B of exp(-tan^2 / m_B^2) / cos^4: Beckmann, Cook-Torrance.
    gauss_m,              ///< m_G = 1 / C_TS of exp(-beta^2 / m_G^2): Torrance-Sparrow.
    ggx_alpha,            ///< C_TR of 1 / (cos^2 + sin^2 / C_TR^2)^2: Trowbridge-Reitz, GGX.
    blender_roughness,    ///< r, where ggx_alpha is r^2: Blender, Disney.
    gtr_alpha,            ///< C_TR of 1 / (cos^2 + sin^2 / C_TR^2)^gamma.
    phong_exponent,       ///< N of cos^N: Blinn-Phong.
    ashikhmin_shirley_n,  ///< N_x or N_y, the Blinn-Phong exponent along an axis.
    schlick_m,            ///< m of Schlick's rational function; 0 where cos < 1 - m.
    sawicki_n,            ///< N_DS of cos / (1 + (N_DS - 1) (1 - cos) / 4)^4.
};

/// A parameter's name, its range, and what it is in a few words.
struct MdfParameterInfo {
    const char* name;
    double low, high;
    const char* meaning;
};

/// In the order of MdfParameter.
inline constexpr std::array<MdfParameterInfo, 9> mdf_parameters{{
    {"beckmann_alpha", 1e-6, 1, "m of Beckmann's exp(-tan^2/m^2)/cos^4 (Cook-Torrance)"},
    {"gauss_m", 1e-6, 2, "m of Gauss's exp(-angle^2/m^2) (1/c of Torrance-Sparrow)"},
    {"ggx_alpha", 1e-6, 1, "alpha of GGX (Trowbridge-Reitz)"},
    {"blender_roughness", 1e-3, 1, "r with ggx_alpha = r^2 (Blender, Disney)"},
    {"gtr_alpha", 1e-6, 1, "alpha of generalised Trowbridge-Reitz with a given gamma"},
    {"phong_exponent", 0.01, 1e13, "N of Blinn-Phong's cos^N"},
    {"ashikhmin_shirley_n", 0.01, 1e13, "N_x or N_y, Blinn-Phong's exponent along an axis"},
    {"schlick_m", 1e-6, 1, "m of Schlick's rational distribution"},
    {"sawicki_n", 0.01, 1e13, "N_DS of Sawicki's rational distribution"},
}};
inline constexpr double smallest_mdf_gamma = 0.5, largest_mdf_gamma = 16;

constexpr const MdfParameterInfo& mdf_info(MdfParameter parameter) {
    return mdf_parameters[static_cast<std::size_t>(parameter)];
}

/// The parameter of a name; throws InvalidInput with the list of names for any other.
LTMD_API MdfParameter parse_mdf_parameter(std::string_view name);

/// D(beta) / D(0) of the distribution whose `parameter` is `value`, 0 for |beta| >= pi/2; exact to
/// rounding for small values too. Beckmann's exceeds 1 off the normal where m_B > 1/sqrt(2).
/// gamma: of gtr_alpha, in [0.5, 16], else unused. Throws InvalidInput for a value outside its
/// range. Source: microfacet-distribution-conversion, Table 1.
LTMD_API double unit_mdf(MdfParameter parameter, double value, double beta, double gamma = 2);

}  // namespace ltmd::inline v0
