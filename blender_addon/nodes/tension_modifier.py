# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Tension: a modifier that stores the deformation of every frame per face corner.

E = [d1 d2] R^-1 of each corner's triangle, R^-1 from LTMD Rest; T = (|Eu|, Eu Ev / |Eu|,
|Eu x Ev| / |Eu|) is averaged over the fan, never across UV seams. Faces of more than three corners
are measured by the triangle at each corner, not by the ones the render cuts them into.
"""

from . import add_input, add_output, ends
from .attribute_tension import ATTRIBUTE
from .fields import Fields
from .rest_modifier import (
    FAN,
    INVERSE_U,
    INVERSE_V,
    corner_offset,
    directed,
    object_matrix,
    vertex_of,
)

TREE = "GeometryNodeTree"
NAME = "LTMD Tension"
VERSION = 1


def add_sockets(tree):
    tree.is_modifier = True
    add_output(tree, "Geometry", "Geometry", "The mesh with its deformation")
    add_input(tree, "Geometry", "Geometry", "The deformed mesh")
    add_input(tree, "Rest", "Object", "Hidden object that holds the rest state")


def rest_geometry(f, rest):
    return f.node("GeometryNodeObjectInfo", {"Object": rest}).outputs["Geometry"]


def when_alike(f, rest, before, after):
    """`after` where the rest state has the faces of the mesh, else `before`."""
    different = None
    sizes = [
        f.node("GeometryNodeAttributeDomainSize", {"Geometry": geometry})
        for geometry in (rest, before)
    ]
    for name in ("Point Count", "Face Corner Count"):
        pair = [size.outputs[name] for size in sizes]
        distance = f.math("ABSOLUTE", f.math("SUBTRACT", *pair))
        different = f.math("ADD", different, distance) if different else distance
    return f.out(
        f.node(
            "GeometryNodeSwitch",
            {"Switch": different, "False": after, "True": before},
            input_type="GEOMETRY",
        )
    )


def edges(f, geometry, rest):
    """Corner fields: Eu and Ev with their weights and the fan, and the geometry that has them."""
    geometry, (p,) = f.capture(
        geometry,
        "POINT",
        p=directed(f, f.out(f.node("GeometryNodeInputPosition")), object_matrix(f)),
    )
    index = f.out(f.node("GeometryNodeInputIndex"))
    geometry, (u, v, d1, d2) = f.capture(
        geometry,
        "CORNER",
        u=f.sample(rest, f.named(INVERSE_U), index, "CORNER"),
        v=f.sample(rest, f.named(INVERSE_V), index, "CORNER"),
        d1=f.vector("SUBTRACT", f.at(p, vertex_of(f, corner_offset(f, 1)), "POINT"), p),
        d2=f.vector("SUBTRACT", f.at(p, vertex_of(f, corner_offset(f, -1)), "POINT"), p),
    )
    a, b, of_fan = f.split(u)
    c, e, of_vertex = f.split(v)
    return (
        geometry,
        d1,
        d2,
        f.combination(a, d1, b, d2),
        f.combination(c, d1, e, d2),
        of_fan,
        of_vertex,
    )


def build(tree):
    add_sockets(tree)
    start, end = ends(tree, 800)
    f = Fields(tree)
    rest = rest_geometry(f, start.outputs["Rest"])
    geometry, _, _, eu, ev, weight, _ = edges(f, start.outputs["Geometry"], rest)
    length = f.out(f.node("ShaderNodeVectorMath", {"Vector": eu}, operation="LENGTH"))
    area = f.out(
        f.node(
            "ShaderNodeVectorMath",
            {"Vector": f.vector("CROSS_PRODUCT", eu, ev)},
            operation="LENGTH",
        )
    )
    t = f.join(
        length,
        f.math("DIVIDE", f.vector("DOT_PRODUCT", eu, ev), length),
        f.math("DIVIDE", area, length),
    )
    fan = f.sample(
        rest, f.named(FAN, "INT"), f.out(f.node("GeometryNodeInputIndex")), "CORNER", "INT"
    )
    geometry, (mean,) = f.capture(
        geometry, "CORNER", mean=f.total(f.scale(t, weight), fan, "FLOAT_VECTOR")
    )
    # A fan without area or UV area at rest: the rest state.
    none = f.math("LESS_THAN", f.split(mean)[0], 1e-30)
    value = f.vector("ADD", mean, f.join(none, 0.0, none))
    f.put(
        end.inputs["Geometry"],
        when_alike(
            f, rest, start.outputs["Geometry"], f.store(geometry, ATTRIBUTE, value, "CORNER")
        ),
    )
