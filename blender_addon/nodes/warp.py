# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Warp: a warp of texture coordinates bends the highlights as if it bent the surface."""

from math import pi

from .. import osl_script
from . import add_input, add_output, add_tension_outputs, add_uv_input, ends, link_script

NAME = "LTMD Warp"
VERSION = 1

PARAMETERS = {
    "Tension": "Deformation",
    "Rotation": "MaterialRotation",
    "Shear": "MaterialShear",
}


def build(tree):
    add_tension_outputs(tree)
    add_output(
        tree,
        "Rotation",
        "Float",
        "For the Rotation of an anisotropic material: its own, turned by the warp",
    )
    add_output(
        tree,
        "Shear",
        "Float",
        "For the Shear of an anisotropic material: its own, mirrored where the warp mirrors",
    )
    add_input(
        tree,
        "Warp",
        "Vector",
        "UV coordinates after any chain of nodes: noise, waves, swirls, maths. The highlights "
        "follow its slope, so blur or smooth coordinates work best. Nodes that give no slope in "
        "Cycles: Vector Rotate by a varying angle, Math Arctan2 (the wrong sign; build swirls from "
        "sine and cosine), and Image Texture in Blender 5.2 (no warp then)",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )
    add_uv_input(tree, "The coordinates before the warp, from a UV Map node")
    add_input(
        tree,
        "Tension",
        "Vector",
        "From another LTMD tension node, to deform the warped surface as well. 1, 0, 1 is none",
        (1.0, 0.0, 1.0),
    )
    add_input(
        tree,
        "Rotation",
        "Float",
        "Rotation of the material's anisotropy; link the output of that name to the material",
        0.0,
        -2 * pi,
        2 * pi,
        subtype="ANGLE",
    )
    add_input(
        tree,
        "Shear",
        "Float",
        "Shear of the material's anisotropy; link the output of that name to the material",
        0.0,
        -10.0,
        10.0,
    )
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_warp")
    link_script(tree, start, script, PARAMETERS)
    for name in ("Tension", "Tangent", "Rotation", "Shear"):
        tree.links.new(script.outputs[name], end.inputs[name])
