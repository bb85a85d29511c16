# SPDX-License-Identifier: GPL-3.0-or-later
"""GTR as few lobes in shader nodes: the fit of osl/include/ltmd_lobe_table.h for any Roughness and
Tail, textured or not.

Each tabulated function of two variables is a sum of products of curves, by its singular value
decomposition: a Vector Curves node holds three curves, so the dot product of two such nodes is
three terms of the sum.
"""

import re
from math import log

import numpy as np

from .. import osl_script
from .node_math import Scalar, Vector

MOST = -2 * log(1e-4)  # the table's last -log(alpha^2)
FINE = 2  # curve points per step of the table
TRIPLES = 2  # of terms


def table(beyond, count):
    """places and logarithms of weights as [lobe, alpha, gamma]."""
    text = (osl_script.folder() / "include" / "ltmd_lobe_table.h").read_text(encoding="utf-8")
    name = f"LTMD_LOBE_TABLE_TO_{4 if beyond else 2}_{count} "
    body = text.split(name)[1].split("#")[0]
    numbers = np.array(re.findall(r"-?\d+\.\d+", body), float)
    steps = [int(re.search(rf"{axis}_STEPS (\d+)", text)[1]) for axis in ("ALPHA", "GAMMA")]
    values = numbers.reshape(steps[0] + 1, steps[1] + 1, 2, count)
    return values.transpose(2, 3, 0, 1)


def refined(values, axis):
    """Lagrange's cubic through four neighbours, as the shaders read the table."""
    values = np.moveaxis(values, axis, 0)
    steps = len(values) - 1
    x = np.linspace(0, steps, FINE * steps + 1)
    first = np.clip(x.astype(int) - 1, 0, steps - 3)
    fine = 0
    for k in range(4):
        weight = np.ones_like(x)
        for other in set(range(4)) - {k}:
            weight = weight * (x - first - other) / (k - other)
        fine = fine + weight[:, None] * values[first + k]
    return np.moveaxis(fine, 0, axis)


def _curves(position, heights):
    """A Vector Curves node at the position; heights are [point, curve]."""
    tree = position.tree
    node = tree.nodes.new("ShaderNodeVectorCurve")
    node.mapping.use_clip = False
    for curve, column in zip(node.mapping.curves, heights.T, strict=True):
        places = np.linspace(0, 1, len(column))
        for point, place, height in ((curve.points[0], 0.0, column[0]),
                                     (curve.points[1], 1.0, column[-1])):  # fmt: skip
            point.location = place, height
        for place, height in zip(places[1:-1], column[1:-1], strict=True):
            curve.points.new(place, height)
        for point in curve.points:
            point.handle_type = "VECTOR"
    node.mapping.update()
    position.feed(node.inputs["Vector"])
    return Vector(tree, node.outputs["Vector"])


def function(values, x, y):
    """A function given at even steps of x and y in [0, 1]."""
    left, size, right = np.linalg.svd(refined(refined(values, 0), 1))
    total = None
    for k in range(TRIPLES):
        terms = slice(3 * k, 3 * k + 3)
        share = np.sqrt(size[terms])
        part = _curves(x, left[:, terms] * share).dot(_curves(y, right[terms].T * share))
        total = total + part if total else part
    return total


def lobes(alpha, tail, count, beyond):
    """[(distribution, alpha, weight)] of the fit; the weights have any sum."""
    tree = alpha.tree
    places, weights = table(beyond, count)
    alpha = alpha.clamped(1e-4, 0.9999)
    log_alpha2 = alpha.log() * 2.0
    if beyond:
        x = (log_alpha2 * (-(MOST + 3) / MOST)) / (3.0 - log_alpha2)
        y = tail.times_plus(0.5, -1.0).clamped(0.0, 1.0)
    else:
        x = log_alpha2 * (-1 / MOST)
        y = (tail * 0.5).clamped(0.0, 1.0)
    made = []
    for k in range(count):
        place = function(places[k], x, y)
        if beyond:
            size = ((log_alpha2 + place) * 0.5).exp()
        else:
            size = (log_alpha2 * place.clamped(0.0, 1.0) * 0.5).exp()
        # The factors are how the weights vanish at the borders; the last weight is the unit.
        weight = Scalar(tree, 1.0)
        if np.any(weights[k]):
            weight = function(weights[k], x, y).exp()
        if beyond and k > 0:
            weight = weight * (tail - 2.0) * (1.0 - alpha * alpha)
        if not beyond:
            weight = weight * tail if k > 0 else weight
            weight = weight * (2.0 - tail) if k + 1 < count else weight
        made.append(("BECKMANN" if beyond and k > 0 else "GGX", size, weight))
    return made
