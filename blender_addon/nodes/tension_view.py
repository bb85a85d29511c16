# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tension View: the deformation in false colour."""

from .. import osl_script
from . import add_input, add_output, ends

NAME = "LTMD Tension View"
VERSION = 1


def build(tree):
    add_output(
        tree,
        "Emission",
        "Shader",
        "Grey at rest, red where stretched, blue where squeezed, purple where both",
    )
    add_input(
        tree,
        "Tension",
        "Vector",
        "From LTMD Live Tension or LTMD Texture Tension",
        (1.0, 0.0, 1.0),
    )
    add_input(
        tree,
        "Range",
        "Float",
        "Factor of stretch (or of squeeze) that is shown in full colour",
        2.0,
        1.001,
        100.0,
    )
    add_input(
        tree,
        "Mode",
        "Int",
        "0 shows the largest and the smallest stretch of any direction, 1 the change of area",
        0,
        0,
        1,
    )
    add_input(
        tree,
        "Shading",
        "Float",
        "Darkens slanted surfaces, so that the shape stays readable; 0 for exact colours",
        0.5,
        0.0,
        1.0,
        subtype="FACTOR",
    )
    start, end = ends(tree, 500)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_view")
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.location = (250, 0)
    for socket in start.outputs:
        if socket.name:
            tree.links.new(socket, script.inputs[socket.name])
    tree.links.new(script.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs["Emission"], end.inputs["Emission"])
