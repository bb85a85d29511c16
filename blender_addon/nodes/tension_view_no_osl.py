# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tension View (no OSL): magnitude and area in the same colours, by stock nodes.

Directions need derivatives, which stock nodes do not have: mode 2 shows the magnitude here.
"""

from . import ends, tension_view
from .node_math import Vector, arrange, inputs

NAME = "LTMD Tension View (no OSL)"
VERSION = 1

REST, SQUEEZED, STRETCHED = (0.52,) * 3, (0.012, 0.10, 0.68), (0.72, 0.022, 0.02)


def build(tree):
    tension_view.add_inputs(tree)
    start, end = ends(tree)
    given = inputs(tree, start)

    # Logarithms of the eigenvalues of T T^t, 1 = full colour.
    t11, t12, t22 = given["Tension"].components()
    xx, xy, yy = t11 * t11 + t12 * t12, t12 * t22, t22 * t22
    half = (xx - yy) * 0.5
    largest = (xx + yy) * 0.5 + (half * half + xy * xy).sqrt()
    area = t11 * t22
    smallest = area * area / largest
    scale = 0.5 / given["Range"].at_least(1.001).log()
    high, low = largest.log() * scale, smallest.log() * scale

    by_area = (given["Mode"] > 0.5) * (given["Mode"] < 1.5)
    stretched = by_area.times_plus(low, high).at_least(0.0)
    squeezed = (-by_area.times_plus(high, low)).at_least(0.0)
    amount = stretched.at_least(squeezed)
    red, blue = stretched**3.0, squeezed**3.0
    part = red / (red + blue).at_least(1e-9)
    hue = part.choose(Vector(tree, STRETCHED), Vector(tree, SQUEEZED))
    colour = amount.at_most(1.0).choose(hue, Vector(tree, REST))

    geometry = tree.nodes.new("ShaderNodeNewGeometry").outputs
    facing = Vector(tree, geometry["Incoming"]).dot(Vector(tree, geometry["Normal"]))
    light = 1.0 - given["Shading"] * (1.0 - abs(facing))
    emission = tree.nodes.new("ShaderNodeEmission")
    colour.feed(emission.inputs["Color"])
    (light / amount.sqrt().at_least(1.0)).feed(emission.inputs["Strength"])
    tree.links.new(emission.outputs[0], end.inputs["Emission"])
    arrange(tree)
