# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tensor Tension (no OSL): the deformation, from six numbers per vertex, by stock nodes.

The steps are those of osl/ltmd_tension_tensor.osl.
"""

from . import add_attribute, add_tension_outputs, add_uv_input, ends
from .node_math import Vector, arrange
from .parameters_no_osl import frame_x, mesh_side, object_axes, usable
from .tensor_tension import DIAGONAL, OFF_DIAGONAL
from .uv_tangent import add_tangent_input, tangent_of

NAME = "LTMD Tensor Tension (no OSL)"
VERSION = 1


def build(tree):
    add_tension_outputs(tree)
    add_uv_input(tree, "The UV map the tension was measured in")
    add_tangent_input(tree)
    start, end = ends(tree)
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    side = mesh_side(tree, Vector(tree, geometry.outputs["Normal"]))
    x = frame_x(tangent_of(tree, start), side)
    x.feed(end.inputs["Tangent"])

    # C = F^t N B N^t F with F = (X Y); N is the object's matrix without its mean scale.
    axes = object_axes(tree)
    size = abs(axes[0].cross(axes[1]).dot(axes[2])) ** (1 / 3)

    def to_object(v):
        return Vector.of(*(axis.dot(v) for axis in axes)) * (1.0 / size)

    x, y = to_object(x), to_object(side.cross(x))
    xx, yy, zz = Vector(tree, add_attribute(tree, DIAGONAL, (0, 0))).components()
    xy, xz, yz = Vector(tree, add_attribute(tree, OFF_DIAGONAL, (0, 0))).components()
    rows = [Vector.of(xx, xy, xz), Vector.of(xy, yy, yz), Vector.of(xz, yz, zz)]
    bx, by = (Vector.of(*(row.dot(v) for row in rows)) for v in (x, y))
    c11, c12, c22 = x.dot(bx), x.dot(by), y.dot(by)
    t22 = c22.sqrt()
    # No tensor gives t22 = 0 or t11 = 0, which is no tension.
    t11 = (c11 * c22 - c12 * c12).sqrt() / t22
    Vector.of(*usable(Vector.of(t11, c12 / t22, t22))).feed(end.inputs["Tension"])
    arrange(tree)
