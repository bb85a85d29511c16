# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Conductor: metal that follows the deformation."""

from .. import osl_script
from . import add_input, add_output, ends, link_script
from .material_inputs import add_material_inputs

NAME = "LTMD Conductor"
VERSION = 1


def add_metal_inputs(tree):
    """What makes the metal: colours or a complex index of refraction."""
    add_input(
        tree,
        "Base Color",
        "Color",
        "Colour of the metal seen straight on. Only for Conductor Type 0",
        (0.617, 0.577, 0.540, 1.0),
    )
    add_input(
        tree,
        "Edge Tint",
        "Color",
        "Tint near the outline, where metals lose a little light; white for none. Only for "
        "Conductor Type 0",
        (0.695, 0.726, 0.770, 1.0),
    )
    add_input(
        tree,
        "Conductor Type",
        "Int",
        "0 takes the colour of the metal from Base Color and Edge Tint, 1 from IOR and Extinction",
        0,
        0,
        1,
    )
    add_input(
        tree,
        "IOR",
        "Vector",
        "Index of refraction in red, green and blue. Only for Conductor Type 1",
        (2.757, 2.513, 2.231),
        0.0,
        100.0,
    )
    add_input(
        tree,
        "Extinction",
        "Vector",
        "How fast light fades inside, in red, green and blue: high values are bright metals. "
        "Only for Conductor Type 1",
        (3.867, 3.404, 3.009),
        0.0,
        100.0,
    )


def build(tree):
    add_output(tree, "BSDF", "Shader", "The metal's reflection")
    add_metal_inputs(tree)
    add_material_inputs(tree)
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_conductor")
    link_script(tree, start, script)
    tree.links.new(script.outputs["BSDF"], end.inputs["BSDF"])
