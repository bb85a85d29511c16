# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Texture Tension (no OSL): the deformation, from one baked image, by stock nodes."""

from . import add_tension_outputs, ends
from .node_math import Vector, arrange, inputs
from .parameters_no_osl import usable
from .texture_tension import add_image_inputs
from .uv_tangent import add_tangent_input, tangent_of

NAME = "LTMD Texture Tension (no OSL)"
VERSION = 1


def build(tree):
    add_tension_outputs(tree)
    add_image_inputs(tree)
    add_tangent_input(tree)
    start, end = ends(tree)
    given = inputs(tree, start)
    tile = given["Tile"] - 1001.0
    row = (tile * 0.1 + 0.05).floor()
    u, v, _ = given["UV"].components()
    # Interpolation may land a point of the tile's edge just outside.
    inside = None
    for place in (u - (tile - row * 10.0), v - row):
        test = abs(place - 0.5) < 0.50001
        inside = inside * test if inside else test
    image = Vector(tree, start.outputs["Image"])
    Vector.of(*usable(inside.choose(image, given["Previous"]))).feed(end.inputs["Tension"])
    tangent_of(tree, start).feed(end.inputs["Tangent"])
    arrange(tree)
