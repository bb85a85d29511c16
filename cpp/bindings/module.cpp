// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include "bindings.h"
#include "ltmd/errors.h"
#include "ltmd/version.h"

#define LTMD_TEXT_(x) #x
#define LTMD_TEXT(x) LTMD_TEXT_(x)

PYBIND11_MODULE(_ltmd, module) {
    using namespace ltmd::python;
    module.doc() = "The compiled part of the package ltmd.";
    module.attr("__version__") = LTMD_TEXT(LTMD_VERSION_MAJOR) "." LTMD_TEXT(
        LTMD_VERSION_MINOR) "." LTMD_TEXT(LTMD_VERSION_PATCH);
    py::register_exception<ltmd::InvalidInput>(module, "InvalidInput", PyExc_ValueError);
    py::register_exception<ltmd::FileError>(module, "FileError", PyExc_OSError);
    py::register_exception<ltmd::Cancelled>(module, "Cancelled", PyExc_RuntimeError);
    bind_threads(module);
    bind_mesh_view(module);
    bind_rest_state(module);
    bind_tension(module);
    bind_deformation_tensor(module);
    bind_lobe_parameters(module);
    bind_any_distribution(module);
    bind_ellipsoid_ndf(module);
    bind_non_centred_distribution(module);
    bind_ggx(module);
    bind_beckmann(module);
    bind_unit_mdf(module);
    bind_tabulated(module);
    bind_fresnel(module);
    bind_masking(module);
    bind_v_cavity(module);
    bind_microfacet_brdf(module);
    bind_lobe_mixture(module);
    bind_gtr(module);
    bind_std_distribution(module);
    bind_phong(module);
    bind_mdf_conversion(module);
    bind_smith_masking(module);
    bind_height_masking(module);
    bind_diffuse_microfacets(module);
    bind_multiple_scattering(module);
    bind_sheen(module);
    bind_gauss(module);
    bind_schlick_mdf(module);
    bind_sawicki_ds(module);
    bind_discrete_ggx(module);
    bind_ashikhmin_shirley(module);
    bind_texel_coverage(module);
    bind_exr(module);
    bind_sequence_baker(module);
    bind_verify(module);
}
