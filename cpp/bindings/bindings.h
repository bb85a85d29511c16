// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>

#include "arrays.h"
#include "ltmd/exr.h"
#include "ltmd/lobe_parameters.h"
#include "ltmd/mesh_view.h"
#include "ltmd/rest_state.h"
#include "ltmd/tension.h"

namespace ltmd::python {

/// A mesh that keeps its NumPy arrays alive.
struct Mesh {
    Array<std::int32_t> triangles, corner_vert;
    std::optional<Array<float>> corner_uv;
    std::int32_t vertex_count;

    MeshView view() const;
};

/// A rest state and the mesh it was made for.
struct PreparedRest {
    std::shared_ptr<const Mesh> mesh;
    RestState state;
};

/// `rest` itself if it is a RestState of `mesh`, else one prepared from an array of positions.
std::shared_ptr<const PreparedRest> prepare(const std::shared_ptr<const Mesh>& mesh,
                                            py::handle rest);

Per parse_per(const std::string& name);
Compression parse_compression(const std::string& name);
Precision parse_precision(bool half, std::optional<int> mantissa_bits);
/// alpha: a number or two; m0: None or 2x2. Throws as validate().
Lobe parse_lobe(py::handle alpha, py::handle m0, double strength, double height_response);
Tile parse_tile(py::handle tile);
std::string parse_path(py::handle path);
/// A dict of str; numbers are written as text.
Metadata parse_metadata(const py::dict& metadata);

void bind_mesh_view(py::module_& module);
void bind_rest_state(py::module_& module);
void bind_tension(py::module_& module);
void bind_deformation_tensor(py::module_& module);
void bind_lobe_parameters(py::module_& module);
void bind_texel_coverage(py::module_& module);
void bind_exr(py::module_& module);
void bind_sequence_baker(py::module_& module);
void bind_verify(py::module_& module);
void bind_threads(py::module_& module);
void bind_any_distribution(py::module_& module);
void bind_ellipsoid_ndf(py::module_& module);
void bind_non_centred_distribution(py::module_& module);
void bind_ggx(py::module_& module);
void bind_beckmann(py::module_& module);
void bind_unit_mdf(py::module_& module);
void bind_tabulated(py::module_& module);
void bind_fresnel(py::module_& module);
void bind_masking(py::module_& module);
void bind_v_cavity(py::module_& module);
void bind_microfacet_brdf(py::module_& module);
void bind_lobe_mixture(py::module_& module);
void bind_gtr(py::module_& module);
void bind_std_distribution(py::module_& module);
void bind_phong(py::module_& module);
void bind_mdf_conversion(py::module_& module);
void bind_smith_masking(py::module_& module);
void bind_height_masking(py::module_& module);
void bind_diffuse_microfacets(py::module_& module);
void bind_multiple_scattering(py::module_& module);
void bind_sheen(py::module_& module);
void bind_gauss(py::module_& module);
void bind_schlick_mdf(py::module_& module);
void bind_sawicki_ds(py::module_& module);
void bind_discrete_ggx(py::module_& module);
void bind_ashikhmin_shirley(py::module_& module);

}  // namespace ltmd::python
