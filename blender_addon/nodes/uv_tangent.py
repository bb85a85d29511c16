# SPDX-License-Identifier: GPL-3.0-or-later
"""The tangent of a source of tension without OSL.

A Tangent node's is averaged over the faces around a vertex, where the shaders take each face's own:
on smooth surfaces it differs by a part of the angle between the faces.
"""

from . import add_input
from .node_math import Vector


def add_tangent_input(tree):
    add_input(
        tree,
        "Tangent",
        "Vector",
        "From a Tangent node with the same UV map; not linked: the map active for render",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )


def tangent_of(tree, start):
    """The tangent that is linked, or that of the UV map active for render."""
    node = tree.nodes.new("ShaderNodeTangent")
    node.direction_type = "UV_MAP"
    given = Vector(tree, start.outputs["Tangent"])
    tangent = (given.dot(given) > 0.0).choose(given, Vector(tree, node.outputs[0]))
    geometry = tree.nodes.new("ShaderNodeNewGeometry")

    # Cycles turns tangents into world space as if they were normals, which is wrong for objects of
    # uneven scale: back, into the surface's plane, and forth as a direction.
    def transformed(value, kind, source, target):
        change = tree.nodes.new("ShaderNodeVectorTransform")
        change.vector_type, change.convert_from, change.convert_to = kind, source, target
        value.feed(change.inputs[0])
        return Vector(tree, change.outputs[0])

    normal = Vector(tree, geometry.outputs["Normal"])
    tangent, normal = (
        transformed(value, "NORMAL", "WORLD", "OBJECT").normalized() for value in (tangent, normal)
    )
    tangent = tangent - normal * normal.dot(tangent)
    return transformed(tangent, "VECTOR", "OBJECT", "WORLD")
