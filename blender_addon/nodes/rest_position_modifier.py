# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Rest Position: a modifier that gives each vertex its rest position, behind modifiers that
make geometry or move it with Geometry Nodes. Live tension reads it.
"""

from . import ends
from .fields import Fields
from .rest_positions import REST_ATTRIBUTE
from .tension_modifier import add_sockets, rest_geometry, when_alike

TREE = "GeometryNodeTree"
NAME = "LTMD Rest Position"
VERSION = 1


def build(tree):
    add_sockets(tree)
    start, end = ends(tree, 500)
    f = Fields(tree)
    rest = rest_geometry(f, start.outputs["Rest"])
    position = f.sample(
        rest,
        f.out(f.node("GeometryNodeInputPosition")),
        f.out(f.node("GeometryNodeInputIndex")),
        "POINT",
    )
    stored = f.store(start.outputs["Geometry"], REST_ATTRIBUTE, position, "POINT")
    f.put(end.inputs["Geometry"], when_alike(f, rest, start.outputs["Geometry"], stored))
