# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Normal: wrinkles of a normal map flatten where the skin is stretched."""

from .. import osl_script
from . import add_input, add_output, add_tension_inputs, ends, link_script

NAME = "LTMD Normal"
VERSION = 1

PARAMETERS = {"Normal": "BentNormal"}  # a shader may not have an input and an output of one name


def build(tree):
    add_output(tree, "Normal", "Vector", "For the Normal of a material")
    add_input(
        tree,
        "Normal",
        "Vector",
        "From a Normal Map or Bump node; not linked: the surface's own",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )
    add_tension_inputs(tree)
    add_input(
        tree,
        "Strength",
        "Float",
        "How much the bumps follow the deformation: 0 keeps their slopes, 1 is exact, more "
        "exaggerates",
        1.0,
        0.0,
        4.0,
    )
    add_input(
        tree,
        "Height Response",
        "Float",
        "What a change of area does to the bumps. 0: they keep their height; 1: they keep their "
        "volume, so stretching flattens wrinkles more and squeezing raises them",
        0.0,
        -1.0,
        2.0,
    )
    add_input(
        tree,
        "From Bump",
        "Bool",
        "Turn on for a Bump node: Blender measures its slopes on the deformed surface, where they "
        "have followed the stretch already, so only Strength and Height Response change them",
        False,
    )
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_normal")
    link_script(tree, start, script, PARAMETERS)
    tree.links.new(script.outputs["Normal"], end.inputs["Normal"])
