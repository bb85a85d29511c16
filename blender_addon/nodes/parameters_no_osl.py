# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Parameters (no OSL): the deformed highlight in numbers for other BSDF nodes, by stock nodes.

The steps are those of osl/include/ltmd_alpha2.h, ltmd_frame.h and ltmd_tension.h. One simplifies: a
tension beyond stretches of 1e-3 or 1e3 keeps its principal directions when it is clamped.
"""

from . import ends
from .material_inputs import add_roughness_inputs, add_surface_inputs
from .node_math import Scalar, Vector, arrange, inputs
from .parameters import add_parameter_outputs

NAME = "LTMD Parameters (no OSL)"
VERSION = 1


def object_axes(tree):
    """The columns of the object's matrix."""
    axes = []
    for index in range(3):
        node = tree.nodes.new("ShaderNodeVectorTransform")
        node.vector_type, node.convert_from, node.convert_to = "VECTOR", "OBJECT", "WORLD"
        node.inputs[0].default_value = [float(index == k) for k in range(3)]
        axes.append(Vector(tree, node.outputs[0]))
    return axes


def mesh_side(tree, normal):
    """The normal on the side where the mesh's corners run counter-clockwise: Cycles' normals face
    the viewer, and outwards on mirrored objects."""
    axes = object_axes(tree)
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    front = Scalar(tree, geometry.outputs["Backfacing"]).times_plus(-2.0, 1.0)
    volume = axes[0].cross(axes[1]).dot(axes[2])
    return normal * ((volume * front) < 0.0).times_plus(-2.0, 1.0)


def frame_x(tangent, normal):
    """The tangent made orthogonal to the normal; any direction if it gives none."""
    tree = normal.tree
    tangent = tangent.bounded(1e9)
    x = tangent - normal * normal.dot(tangent)
    usable = x.dot(x) > tangent.dot(tangent) * 1e-12
    nearly_x = abs(normal.components()[0]) > 0.9
    other = normal.cross(nearly_x.choose(Vector(tree, (0, 1, 0)), Vector(tree, (1, 0, 0))))
    return usable.choose(x, other).normalized()


def usable(tension):
    """t11, t12, t22 of a tension, or of the identity where it has no meaning."""
    bounded = tension.bounded(1e9)
    t11, t12, t22 = bounded.components()
    good = (t11 > 0.0) * (t22 > 0.0) * (abs(t12) + t11 + t22 < 1e9)
    return good.choose(bounded, Vector(tension.tree, (1, 0, 1))).components()


def alpha_of(given):
    """Alpha at rest."""
    roughness = given["Roughness"].clamped(0.0, 1.0)
    return given["Roughness Is Alpha"].choose(roughness, roughness * roughness)


def principal(xx, xy, yy):
    """Of a symmetric matrix: half the difference of the diagonal, half that of the eigenvalues, and
    the larger eigenvalue."""
    difference = (xx - yy) * 0.5
    radius = (difference * difference + xy * xy).sqrt()
    return difference, radius, (xx + yy).times_plus(0.5, radius)


def build(tree):
    add_parameter_outputs(tree)
    add_roughness_inputs(tree)
    add_surface_inputs(tree)
    start, end = ends(tree)
    given = inputs(tree, start)

    alpha = alpha_of(given).at_least(1e-10)  # 0 would hide the alphas' ratio

    # T = V Rot(phi), by the eigenvalues of T T^t; V^s = mean I + half (cos, sin; sin, -cos).
    t11, t12, t22 = usable(given["Tension"])
    xy = t12 * t22
    difference, radius, largest = principal(t11 * t11 + t12 * t12, xy, t22 * t22)
    area = t11 * t22
    power = given["Strength"] * 0.5
    a = largest.clamped(1e-6, 1e6) ** power
    b = (area * area / largest).clamped(1e-6, 1e6) ** power
    mean = (a + b) * 0.5
    half = (a - b) * 0.5 / radius  # dividing by 0 gives 0
    vxy = half * xy
    vxx, vyy = half.times_plus(difference, mean), mean - half * difference

    # M = V^s Rot(s phi + rotation) (sx, shear / sx; 0, 1 / sx).
    angle = (t12 * -1.0).atan2(t11 + t22).times_plus(given["Strength"], given["Rotation"])
    c, s = angle.cos(), angle.sin()
    stretch = given["Stretch"].clamped(-0.99, 0.99)
    sx = (stretch.at_most(0.0) + 1.0) / (1.0 - stretch.at_least(0.0))
    along, across = Vector.of(c, s), Vector.of(s * -1.0, c)
    inverse = 1.0 / sx
    u = along * sx
    w = along * (given["Shear"] * inverse) + across * inverse
    vx, vy = Vector.of(vxx, vxy), Vector.of(vxy, vyy)
    mx, my = Vector.of(vx.dot(u), vx.dot(w)), Vector.of(vy.dot(u), vy.dot(w))

    # Eigenvalues and eigenvector of M M^t; det M = det V^s = a b.
    xx, xy, yy = mx.dot(mx), mx.dot(my), my.dot(my)
    difference, radius, largest = principal(xx, xy, yy)
    det = a * b
    scale = alpha * det ** (given["Height Response"] * -1.0)
    longest = largest.sqrt()
    alpha_x, alpha_y = scale / longest, scale * longest / det
    turn = xy.atan2(difference) * 0.5
    c, s = turn.cos(), turn.sin()

    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    linked = given["Normal"].dot(given["Normal"]) > 0.0
    shading = linked.choose(given["Normal"], Vector(tree, geometry.outputs["Normal"]))
    side = mesh_side(tree, shading.normalized())
    x = frame_x(given["Tangent"], side)
    y = side.cross(x)

    # As Cycles clamps them in a microfacet closure.
    small, large = alpha_x.at_most(1.0), alpha_y.at_most(1.0)
    ratio = small / large.at_least(1e-30)
    per_det = scale / det
    per_det = per_det * per_det
    for name, value in (
        ("Roughness", (small * large).sqrt().sqrt()),
        ("Anisotropy", 1.0 - ratio.sqrt()),
        ("Anisotropic", ((1.0 - ratio) / 0.9).at_most(1.0)),
        ("Tangent", x * c + y * s),
        ("Principled Tangent", y * c - x * s),
        ("Alpha X", alpha_x),
        ("Alpha Y", alpha_y),
        ("Alpha Squared", Vector.of(yy, xy * -1.0, xx) * per_det),
    ):
        value.feed(end.inputs[name])
    arrange(tree)
