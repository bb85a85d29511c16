# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tensor Tension: the deformation, from six numbers per vertex that need no UV map."""

from .. import osl_script
from . import add_attribute, add_tension_outputs, add_uv_input, ends

NAME = "LTMD Tensor Tension"
VERSION = 1

DIAGONAL = "ltmd_tensor_diagonal"
OFF_DIAGONAL = "ltmd_tensor_off_diagonal"


def build(tree):
    add_tension_outputs(tree)
    add_uv_input(
        tree, "From a UV Map node. Not needed while the material is isotropic (Stretch and Shear 0)"
    )
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_tensor")
    link = tree.links.new
    link(add_attribute(tree, DIAGONAL, (-200, 400)), script.inputs["Diagonal"])
    link(add_attribute(tree, OFF_DIAGONAL, (-200, 200)), script.inputs["OffDiagonal"])
    link(start.outputs["UV"], script.inputs["UV"])
    link(script.outputs["Tension"], end.inputs["Tension"])
    link(script.outputs["Tangent"], end.inputs["Tangent"])
