# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Live Tension: the deformation, measured while rendering.

The rest state is the point attribute `ltmd_rest` where the mesh has one, otherwise the Generated
coordinates: those are the undeformed surface divided by twice the texture space's size, which an
Attribute node reads from each object's own mesh, so one material serves many objects.
"""

from .. import osl_script
from . import add_input, add_tension_outputs, ends

NAME = "LTMD Live Tension"
VERSION = 1

REST_ATTRIBUTE = "ltmd_rest"


def build(tree):
    add_tension_outputs(tree)
    add_input(
        tree,
        "UV",
        "Vector",
        "From a UV Map node. Not needed while the material is isotropic (Stretch and Shear 0)",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )
    start, end = ends(tree)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_live")
    script.location = (300, 0)

    rest = tree.nodes.new("ShaderNodeAttribute")
    rest.attribute_name = REST_ATTRIBUTE
    rest.location = (-300, 300)

    generated = tree.nodes.new("ShaderNodeTexCoord")
    generated.location = (-300, 100)
    size = tree.nodes.new("ShaderNodeAttribute")
    size.attribute_type = "OBJECT"
    size.attribute_name = "texspace_size"
    size.location = (-300, -200)
    unscaled = tree.nodes.new("ShaderNodeVectorMath")
    unscaled.operation = "MULTIPLY"
    unscaled.location = (-100, 0)
    doubled = tree.nodes.new("ShaderNodeVectorMath")
    doubled.operation = "SCALE"
    doubled.inputs["Scale"].default_value = 2.0
    doubled.location = (100, 0)

    link = tree.links.new
    link(rest.outputs["Vector"], script.inputs["Rest"])
    link(generated.outputs["Generated"], unscaled.inputs[0])
    link(size.outputs["Vector"], unscaled.inputs[1])
    link(unscaled.outputs["Vector"], doubled.inputs[0])
    link(doubled.outputs["Vector"], script.inputs["RestFallback"])
    link(start.outputs["UV"], script.inputs["UV"])
    link(script.outputs["Tension"], end.inputs["Tension"])
    link(script.outputs["Tangent"], end.inputs["Tangent"])
