# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Rest: what LTMD Tension and LTMD Tensor need of the rest state, once per face corner.

It sits on the hidden object that holds the rest state. Every corner has the triangle (corner, next,
previous) of its face; E = [d1 d2] R^-1 with the edges R at rest in a frame whose x is along dP/du.
Stored: the columns of R^-1 (their third components are the weights of the corner in the mean of its
fan and of its vertex) and the number of the fan, the corners of a vertex with one UV and one sign
of the UV area. Positions are in the metric of the rendered object.
"""

from . import add_input, add_output, ends
from .fields import Fields

TREE = "GeometryNodeTree"
NAME = "LTMD Rest"
VERSION = 1

INVERSE_U = "ltmd_inverse_u"  # (R^-1_11, R^-1_21, weight in the fan)
INVERSE_V = "ltmd_inverse_v"  # (R^-1_12, R^-1_22, weight at the vertex)
FAN = "ltmd_fan"
# Corners of a vertex that are compared; a vertex has seldom more.
MOST_CORNERS = 16


def object_matrix(f):
    """The matrix of the object that has the modifier, without its mean scale."""
    info = f.node(
        "GeometryNodeObjectInfo",
        {"Object": f.out(f.node("GeometryNodeSelfObject"))},
        transform_space="ORIGINAL",
    )
    matrix = info.outputs["Transform"]
    volume = f.math("ABSOLUTE", f.out(f.node("FunctionNodeMatrixDeterminant", {"Matrix": matrix})))
    unit = f.math("POWER", volume, -1 / 3)
    scale = f.node("FunctionNodeCombineTransform", {"Scale": f.join(unit, unit, unit)})
    product = f.node("FunctionNodeMatrixMultiply")
    f.put(product.inputs[0], matrix)
    f.put(product.inputs[1], f.out(scale))
    return f.out(product)


def directed(f, vector, matrix):
    return f.out(
        f.node("FunctionNodeTransformDirection", {"Direction": vector, "Transform": matrix})
    )


def corner_offset(f, offset):
    """The next or previous corner of the face."""
    return f.out(f.node("GeometryNodeOffsetCornerInFace", {"Offset": offset}))


def vertex_of(f, corner=None):
    inputs = {} if corner is None else {"Corner Index": corner}
    return f.out(f.node("GeometryNodeVertexOfCorner", inputs))


def _has_area(f, area, first, second):
    """1 where a triangle's two edges span a usable area, else 0."""
    longest = f.math(
        "MAXIMUM", f.vector("DOT_PRODUCT", first, first), f.vector("DOT_PRODUCT", second, second)
    )
    return f.math("GREATER_THAN", area, f.math("MULTIPLY", longest, 1e-6))


def build(tree):
    tree.is_modifier = True
    add_output(tree, "Geometry", "Geometry", "The mesh with the numbers of its rest state")
    add_input(tree, "Geometry", "Geometry", "The rest state")
    add_input(tree, "UV Map", "String", "The UV map of the highlights")
    start, end = ends(tree, 800)
    f = Fields(tree)

    geometry, (p,) = f.capture(
        start.outputs["Geometry"],
        "POINT",
        p=directed(f, f.out(f.node("GeometryNodeInputPosition")), object_matrix(f)),
    )
    following, before = corner_offset(f, 1), corner_offset(f, -1)
    uv_map = f.named(start.outputs["UV Map"])
    geometry, (uv, r1, r2, w1, w2) = f.capture(
        geometry,
        "CORNER",
        uv=uv_map,
        r1=f.vector("SUBTRACT", f.at(p, vertex_of(f, following), "POINT"), p),
        r2=f.vector("SUBTRACT", f.at(p, vertex_of(f, before), "POINT"), p),
        w1=f.vector("SUBTRACT", f.at(uv_map, following, "CORNER"), uv_map),
        w2=f.vector("SUBTRACT", f.at(uv_map, before, "CORNER"), uv_map),
    )
    u1, v1, _ = f.split(w1)
    u2, v2, _ = f.split(w2)
    det = f.math("SUBTRACT", f.math("MULTIPLY", u1, v2), f.math("MULTIPLY", u2, v1))
    sign = f.math("SIGN", det)
    has_uv = _has_area(f, f.math("ABSOLUTE", det), w1, w2)
    cross = f.vector("CROSS_PRODUCT", r1, r2)
    area = f.out(f.node("ShaderNodeVectorMath", {"Vector": cross}, operation="LENGTH"))
    along_u = f.scale(f.vector("SUBTRACT", f.scale(r1, v2), f.scale(r2, v1)), sign)
    towards = f.vector(
        "ADD", f.scale(along_u, has_uv), f.scale(r1, f.math("SUBTRACT", 1.0, has_uv))
    )
    x = f.vector("NORMALIZE", towards)
    y = f.vector("CROSS_PRODUCT", f.vector("NORMALIZE", cross), x)

    def over_area(value, factor=1.0):
        return f.math("DIVIDE", f.math("MULTIPLY", value, factor), area)

    usable = f.math("MULTIPLY", _has_area(f, area, r1, r2), area)
    geometry, (a, b, c, e, of_fan, of_vertex, sign) = f.capture(
        geometry,
        "CORNER",
        a=over_area(f.vector("DOT_PRODUCT", r2, y)),
        b=over_area(f.vector("DOT_PRODUCT", r1, y), -1.0),
        c=over_area(f.vector("DOT_PRODUCT", r2, x), -1.0),
        e=over_area(f.vector("DOT_PRODUCT", r1, x)),
        of_fan=f.math("MULTIPLY", usable, has_uv),
        of_vertex=usable,
        sign=sign,
    )

    # The fan's number is its first corner.
    index = f.out(f.node("GeometryNodeInputIndex"))
    vertex = vertex_of(f)
    fan = index
    for k in range(MOST_CORNERS):
        other = f.out(
            f.node("GeometryNodeCornersOfVertex", {"Vertex Index": vertex, "Sort Index": k})
        )
        distance = f.vector("DISTANCE", f.at(uv, other, "CORNER"), uv)
        turned = f.math("SUBTRACT", f.at(sign, other, "CORNER", "FLOAT"), sign)
        differs = f.math("GREATER_THAN", f.math("ADD", distance, f.math("ABSOLUTE", turned)), 0.0)
        fan = f.integer(
            "MINIMUM",
            fan,
            f.out(
                f.node(
                    "GeometryNodeSwitch",
                    {"Switch": differs, "False": other, "True": index},
                    input_type="INT",
                )
            ),
        )
    geometry, (fan, vertex) = f.capture(geometry, "CORNER", fan=fan, vertex=vertex)

    weight = f.math("DIVIDE", of_fan, f.total(of_fan, fan))
    # A point attribute is the plain mean over its corners: times their number.
    count = f.total(1.0, vertex)
    share = f.math("DIVIDE", f.math("MULTIPLY", of_vertex, count), f.total(of_vertex, vertex))
    geometry = f.store(geometry, INVERSE_U, f.join(a, b, weight), "CORNER")
    geometry = f.store(geometry, INVERSE_V, f.join(c, e, share), "CORNER")
    geometry = f.store(geometry, FAN, fan, "CORNER", "INT")
    f.put(end.inputs["Geometry"], geometry)
