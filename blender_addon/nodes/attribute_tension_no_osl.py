# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Attribute Tension (no OSL): the deformation, from an attribute, by stock nodes."""

from . import add_attribute, add_tension_outputs, add_uv_input, ends
from .attribute_tension import ATTRIBUTE
from .node_math import Vector, arrange
from .parameters_no_osl import usable
from .uv_tangent import add_tangent_input, tangent_of

NAME = "LTMD Attribute Tension (no OSL)"
VERSION = 1


def build(tree):
    add_tension_outputs(tree)
    add_uv_input(tree, "The UV map the tension was measured in")
    add_tangent_input(tree)
    start, end = ends(tree)
    tension = Vector(tree, add_attribute(tree, ATTRIBUTE, (0, 0)))
    Vector.of(*usable(tension)).feed(end.inputs["Tension"])
    tangent_of(tree, start).feed(end.inputs["Tangent"])
    arrange(tree)
