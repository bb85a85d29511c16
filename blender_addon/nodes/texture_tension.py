# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Texture Tension: the deformation, from one baked image; chain one per UDIM tile."""

from .. import osl_script
from . import add_input, add_tension_outputs, add_uv_input, ends, link_script

NAME = "LTMD Texture Tension"
VERSION = 1


def add_image_inputs(tree):
    """The pixel of one tile, and the tension of the others."""
    add_input(
        tree,
        "Image",
        "Color",
        "Color of an Image Texture node with the baked image (data, extended)",
        (1.0, 0.0, 1.0, 1.0),
        hide_value=True,
    )
    add_uv_input(tree, "From a UV Map node with the UV map that was baked")
    add_input(tree, "Tile", "Int", "UDIM number of the image; 1001 without UDIM", 1001, 1001, 2000)
    add_input(
        tree,
        "Previous",
        "Vector",
        "Tension of the other tiles, from another LTMD Texture Tension node",
        (1.0, 0.0, 1.0),
    )


def build(tree):
    add_tension_outputs(tree)
    add_image_inputs(tree)
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_texture")
    link_script(tree, start, script)
    tree.links.new(script.outputs["Tension"], end.inputs["Tension"])
    tree.links.new(script.outputs["Tangent"], end.inputs["Tangent"])
