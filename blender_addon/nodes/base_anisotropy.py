# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Base Anisotropy: the anisotropy of a Principled, Glossy or Metallic BSDF as Stretch and
Rotation at rest, in the frame of the tension.

The BSDF's own tangent may be of another UV map, or none: it is taken to be drawn on the surface, so
that the tension's inverse brings it back to rest. Stock nodes alone.
"""

from math import pi

from . import add_input, add_output, ends
from .node_math import Scalar, Vector, arrange, inputs
from .parameters_no_osl import frame_x, mesh_side, usable

NAME = "LTMD Base Anisotropy"
VERSION = 1


def build(tree):
    add_output(tree, "Stretch", "Float", "For LTMD Parameters; of a Principled or Metallic BSDF")
    add_output(tree, "Rotation", "Float", "For LTMD Parameters")
    add_output(
        tree,
        "No Rotation",
        "Float",
        "0, for the rotation of the BSDF: the direction is in its tangent now",
    )
    add_input(
        tree,
        "Anisotropic",
        "Float",
        "Anisotropy as in a Principled or Metallic BSDF",
        0.0,
        0.0,
        1.0,
        subtype="FACTOR",
    )
    add_input(tree, "Base Rotation", "Float", "Turn of the tangent; 1 is a full turn", 0.0)
    add_input(
        tree,
        "Base Tangent",
        "Vector",
        "Direction of the anisotropy; not linked: around the object's Z axis, as stock nodes do",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )
    add_input(tree, "Tension", "Vector", "As for LTMD Parameters", (1.0, 0.0, 1.0))
    for name in ("Tangent", "Normal"):
        add_input(tree, name, "Vector", "As for LTMD Parameters", (0.0, 0.0, 0.0), hide_value=True)
    start, end = ends(tree)
    given = inputs(tree, start)
    geometry = tree.nodes.new("ShaderNodeNewGeometry")

    # Rough along the tangent: alpha_x = alpha / aspect with aspect^2 = 1 - 0.9 A.
    aspect = (1.0 - given["Anisotropic"].clamped(0.0, 1.0) * 0.9).sqrt()
    (aspect - 1.0).feed(end.inputs["Stretch"])

    def linked_or(name, output):
        length = given[name].dot(given[name])
        return (length > 0.0).choose(given[name], Vector(tree, geometry.outputs[output]))

    normal = linked_or("Normal", "Normal").normalized()
    tangent = linked_or("Base Tangent", "Tangent")
    side = mesh_side(tree, normal)
    x = frame_x(given["Tangent"], side)
    p, q = tangent.dot(x), tangent.dot(side.cross(x))
    # T^-1 (p, q), times det T; then the BSDF's turn, which is about the normal it sees.
    t11, t12, t22 = usable(given["Tension"])
    angle = (q * t11).atan2(p * t22 - t12 * q)
    turn = given["Base Rotation"] * (2 * pi)
    turn.times_plus(normal.dot(side), angle).feed(end.inputs["Rotation"])
    Scalar(tree, 0.0).feed(end.inputs["No Rotation"])
    arrange(tree)
