# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tension View (no OSL): magnitude and area in the same colours, by stock nodes.

Directions need derivatives, which stock nodes do not have: mode 2 shows the magnitude here.
"""

from math import e

from . import ends, tension_view

NAME = "LTMD Tension View (no OSL)"
VERSION = 1

REST, SQUEEZED, STRETCHED = (0.52,) * 3, (0.012, 0.10, 0.68), (0.72, 0.022, 0.02)


def build(tree):
    tension_view.add_inputs(tree)
    start, end = ends(tree, 1400)
    column = [0]

    def node(kind, *sources, **settings):
        made = tree.nodes.new(kind)
        for key, value in settings.items():
            setattr(made, key, value)
        made.location = (-1200 + 150 * (column[0] // 4), 300 - 180 * (column[0] % 4))
        column[0] += 1
        # A disabled socket belongs to another data type or operation.
        for socket, source in zip((s for s in made.inputs if s.enabled), sources, strict=False):
            if isinstance(source, int | float | tuple):
                socket.default_value = source
            else:
                tree.links.new(source, socket)
        return made

    def maths(operation, *sources, **settings):
        return node("ShaderNodeMath", *sources, operation=operation, **settings).outputs[0]

    def mixed(factor, a, b):
        made = node("ShaderNodeMix", factor, a, b, data_type="RGBA")
        return next(s for s in made.outputs if s.enabled)

    given = start.outputs
    t11, t12, t22 = node("ShaderNodeSeparateXYZ", given["Tension"]).outputs

    # Logarithms of the eigenvalues of T T^t, 1 = full colour.
    xx = maths("ADD", maths("MULTIPLY", t11, t11), maths("MULTIPLY", t12, t12))
    yy = maths("MULTIPLY", t22, t22)
    xy = maths("MULTIPLY", t12, t22)
    mean = maths("MULTIPLY", maths("ADD", xx, yy), 0.5)
    half = maths("MULTIPLY", maths("SUBTRACT", xx, yy), 0.5)
    apart = maths("SQRT", maths("ADD", maths("MULTIPLY", half, half), maths("MULTIPLY", xy, xy)))
    largest = maths("ADD", mean, apart)
    area = maths("MULTIPLY", t11, t22)
    smallest = maths("DIVIDE", maths("MULTIPLY", area, area), largest)
    full = maths("LOGARITHM", maths("MAXIMUM", given["Range"], 1.001), e)
    scale = maths("DIVIDE", 0.5, full)
    high = maths("MULTIPLY", maths("LOGARITHM", largest, e), scale)
    low = maths("MULTIPLY", maths("LOGARITHM", smallest, e), scale)

    # Mode 1 takes the sum of both.
    by_area = maths("COMPARE", given["Mode"], 1.0, 0.5)
    stretched = maths("MAXIMUM", maths("MULTIPLY_ADD", by_area, low, high), 0.0)
    squeezed = maths(
        "MAXIMUM", maths("MULTIPLY", maths("MULTIPLY_ADD", by_area, high, low), -1.0), 0.0
    )
    amount = maths("MAXIMUM", stretched, squeezed)
    red, blue = maths("POWER", stretched, 3.0), maths("POWER", squeezed, 3.0)
    part = maths("DIVIDE", red, maths("MAXIMUM", maths("ADD", red, blue), 1e-9))
    hue = mixed(part, (*SQUEEZED, 1.0), (*STRETCHED, 1.0))
    colour = mixed(maths("MINIMUM", amount, 1.0), (*REST, 1.0), hue)

    geometry = node("ShaderNodeNewGeometry").outputs
    facing = node(
        "ShaderNodeVectorMath", geometry["Incoming"], geometry["Normal"], operation="DOT_PRODUCT"
    ).outputs["Value"]
    slant = maths("SUBTRACT", 1.0, maths("ABSOLUTE", facing))
    light = maths("SUBTRACT", 1.0, maths("MULTIPLY", given["Shading"], slant))
    beyond = maths("MAXIMUM", maths("SQRT", amount), 1.0)
    emission = node("ShaderNodeEmission", colour, maths("DIVIDE", light, beyond))
    tree.links.new(emission.outputs[0], end.inputs["Emission"])
