# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tension View: the deformation in false colour."""

from .. import osl_script
from . import add_input, add_output, add_tension_inputs, ends, link_script
from .rest_positions import add_rest_positions

NAME = "LTMD Tension View"
VERSION = 2

LEGEND = "Grey at rest, red where stretched, blue where squeezed, purple where both"


def add_inputs(tree):
    """What every view takes."""
    add_output(tree, "Emission", "Shader", LEGEND)
    add_tension_inputs(tree)
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
        "0 shows the largest and the smallest stretch of any direction, 1 the change of area, "
        "2 also the direction of the largest stretch, by strokes",
        0,
        0,
        2,
    )
    add_input(
        tree,
        "Density",
        "Float",
        "How many strokes fit along the longest side of the object",
        30.0,
        1.0,
        1000.0,
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


def build(tree):
    add_inputs(tree)
    start, end = ends(tree, 600)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_tension_view")
    script.location = (150, 0)
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.location = (400, 0)
    link = tree.links.new
    rest, fallback, size = add_rest_positions(tree, -200, -150)
    link(rest, script.inputs["Rest"])
    link(fallback, script.inputs["RestFallback"])
    link(size, script.inputs["RestSize"])
    link_script(tree, start, script)
    link(script.outputs["Color"], emission.inputs["Color"])
    link(emission.outputs["Emission"], end.inputs["Emission"])
