# SPDX-License-Identifier: Apache-2.0
"""LTMD: measure how a mesh deforms and bake it for renderers.

Positions are float32 in Blender units, in the metric of the rendered object; UVs are (u, v) with v
up; tensions are (t11, t12, t22) of T = [[t11, t12], [0, t22]]; (1, 0, 1) is the undeformed state.
"""

from ltmd._ltmd import (
    Cancelled,
    FileError,
    InvalidInput,
    Mesh,
    RestReport,
    RestState,
    SequenceBaker,
    TexelCoverage,
    VerifyReport,
    __version__,
    bake,
    convention,
    deformation_tensor,
    exr_metadata,
    passes,
    project_tensor,
    read_exr,
    set_threads,
    stretch,
    tension,
    tension_matrix,
    threads,
    udim,
    verify,
    write_exr,
)

__all__ = [
    "Cancelled",
    "FileError",
    "InvalidInput",
    "Mesh",
    "RestReport",
    "RestState",
    "SequenceBaker",
    "TexelCoverage",
    "VerifyReport",
    "__version__",
    "bake",
    "convention",
    "deformation_tensor",
    "exr_metadata",
    "passes",
    "project_tensor",
    "read_exr",
    "set_threads",
    "stretch",
    "tension",
    "tension_matrix",
    "threads",
    "udim",
    "verify",
    "write_exr",
]
