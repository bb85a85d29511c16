# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Attribute Tension: the deformation, from an attribute of the mesh."""

from .. import osl_script
from . import add_attribute, add_tension_outputs, add_uv_input, ends

NAME = "LTMD Attribute Tension"
VERSION = 1

ATTRIBUTE = "ltmd_tension"


def build(tree):
    add_tension_outputs(tree)
    add_uv_input(
        tree,
        "From a UV Map node with the UV map the tension was measured in; without it the highlights "
        "point in wrong directions",
    )
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_attribute")
    link = tree.links.new
    link(add_attribute(tree, ATTRIBUTE, (-200, 200)), script.inputs["Attribute"])
    link(start.outputs["UV"], script.inputs["UV"])
    link(script.outputs["Tension"], end.inputs["Tension"])
    link(script.outputs["Tangent"], end.inputs["Tangent"])
