# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tensor: a modifier that stores the deformation of every frame as six numbers per vertex.

B = E E^t of each corner's triangle, turned by the smallest rotation from the triangle's normal to
the vertex's, averaged by rest area. Stored in the object's space as LTMD Tensor Tension reads it.
"""

from . import ends
from .fields import Fields
from .rest_modifier import directed, object_matrix
from .tension_modifier import add_sockets, edges, rest_geometry, when_alike
from .tensor_tension import DIAGONAL, OFF_DIAGONAL

TREE = "GeometryNodeTree"
NAME = "LTMD Tensor"
VERSION = 1


def _turned(f, v, axis, cosine):
    """v turned about an axis of length sine: v cos + axis x v + axis (axis . v) / (1 + cos)."""
    along = f.math("DIVIDE", f.vector("DOT_PRODUCT", axis, v), f.math("ADD", 1.0, cosine))
    return f.vector(
        "ADD",
        f.vector("ADD", f.scale(v, cosine), f.vector("CROSS_PRODUCT", axis, v)),
        f.scale(axis, along),
    )


def build(tree):
    add_sockets(tree)
    start, end = ends(tree, 800)
    f = Fields(tree)
    rest = rest_geometry(f, start.outputs["Rest"])
    matrix = object_matrix(f)
    inverse = f.out(f.node("FunctionNodeInvertMatrix", {"Matrix": matrix}))
    transposed = f.out(f.node("FunctionNodeTransposeMatrix", {"Matrix": inverse}))
    handedness = f.out(f.node("FunctionNodeMatrixDeterminant", {"Matrix": matrix}))

    # The vertex's normal on the side on which the corners run counter-clockwise.
    normal = f.out(f.node("GeometryNodeInputNormal"), "True Normal")
    normal = f.vector("NORMALIZE", f.scale(directed(f, normal, transposed), handedness))
    geometry, (normal,) = f.capture(start.outputs["Geometry"], "POINT", normal=normal)
    geometry, d1, d2, eu, ev, _, weight = edges(f, geometry, rest)
    own = f.vector("NORMALIZE", f.vector("CROSS_PRODUCT", d1, d2))
    axis = f.vector("CROSS_PRODUCT", own, normal)
    cosine = f.vector("DOT_PRODUCT", own, normal)
    factor = f.math("SQRT", weight)
    sums = None
    for e in (eu, ev):
        e = f.scale(directed(f, _turned(f, e, axis, cosine), inverse), factor)
        x, y, z = f.split(e)
        parts = (
            f.vector("MULTIPLY", e, e),
            f.vector("MULTIPLY", f.join(x, x, y), f.join(y, z, z)),
        )
        sums = [f.vector("ADD", *pair) for pair in zip(sums, parts, strict=True)] if sums else parts
    # Products of the corners first: a field on points averages what it is made of.
    geometry, sums = f.capture(geometry, "CORNER", diagonal=sums[0], off_diagonal=sums[1])
    geometry, (diagonal, off_diagonal) = f.capture(
        geometry, "POINT", diagonal=sums[0], off_diagonal=sums[1]
    )
    # No face with area: the rest state.
    none = f.math("LESS_THAN", f.vector("DOT_PRODUCT", diagonal, (1.0, 1.0, 1.0)), 1e-30)
    geometry = f.store(
        geometry, DIAGONAL, f.vector("ADD", diagonal, f.join(none, none, none)), "POINT"
    )
    geometry = f.store(geometry, OFF_DIAGONAL, off_diagonal, "POINT")
    f.put(end.inputs["Geometry"], when_alike(f, rest, start.outputs["Geometry"], geometry))
