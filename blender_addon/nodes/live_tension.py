# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Live Tension: the deformation, measured while rendering."""

from .. import osl_script
from . import add_tension_outputs, add_uv_input, ends
from .rest_positions import add_rest_positions

NAME = "LTMD Live Tension"
VERSION = 2


def build(tree):
    add_tension_outputs(tree)
    add_uv_input(
        tree, "From a UV Map node. Not needed while the material is isotropic (Stretch and Shear 0)"
    )
    start, end = ends(tree)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_live")
    script.location = (300, 0)

    rest, fallback, _size = add_rest_positions(tree, 0, 0)
    link = tree.links.new
    link(rest, script.inputs["Rest"])
    link(fallback, script.inputs["RestFallback"])
    link(start.outputs["UV"], script.inputs["UV"])
    link(script.outputs["Tension"], end.inputs["Tension"])
    link(script.outputs["Tangent"], end.inputs["Tangent"])
