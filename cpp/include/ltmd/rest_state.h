// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "ltmd/export.h"
#include "ltmd/mesh_view.h"

namespace ltmd::inline v0 {

/// What a rest state found in its mesh.
struct RestReport {
    std::size_t degenerate_triangles =
        0;  ///< |e1 x e2| <= 1e-7 max edge^2 at rest: their tension is the identity.
    std::size_t no_uv_triangles = 0;     ///< No UV area: their tension is the identity.
    std::size_t mirrored_triangles = 0;  ///< Negative UV area.
    std::size_t seam_vertices = 0;       ///< Vertices whose faces fall into more than one UV fan.
};

/// The rest state of a mesh, prepared once for any number of deformed states.
///
/// Holds, per triangle, R^-1 (R = the rest edges in the rest frame) and the rest area, and per
/// corner its UV fan: the edge-connected triangles that share the corner's vertex, its UV
/// (bit-equal) and the sign of the UV area. Owns all it needs: the mesh's arrays may be freed.
/// Immutable, so any number of threads may use it.
class LTMD_API RestState {
public:
    /// Validates mesh and positions ([V], finite); throws InvalidInput. A mesh without a UV map is
    /// allowed: then only deformation_tensor works.
    RestState(const MeshView& mesh, std::span<const Vec3f> positions);
    ~RestState();
    RestState(RestState&&) noexcept;
    RestState& operator=(RestState&&) noexcept;

    const RestReport& report() const;
    std::size_t triangle_count() const;
    std::size_t corner_count() const;
    std::size_t vertex_count() const;
    bool has_uv() const;

    struct Data;
    const Data& data() const { return *data_; }

private:
    std::unique_ptr<Data> data_;
};

}  // namespace ltmd::inline v0
