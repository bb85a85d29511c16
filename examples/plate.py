# SPDX-License-Identifier: Apache-2.0
"""A rough silver plate whose microsurface is stretched, skewed and warped: Fig. 1 in kind."""

import math

import gallery
import numpy as np

ALPHA, TAIL = 0.0121, 1.7
SILVER = (0.962, 0.949, 0.922)
AWAY, RAISED = 11.0, math.radians(58)


def sketch(warp):
    """The unit square's grid after the map, as lines that fit a unit square."""
    t = np.linspace(0, 1, 33)
    lines = []
    for at in np.linspace(0, 1, 5):
        at = np.full_like(t, at)
        lines += [np.stack(warp(at, t), -1), np.stack(warp(t, at), -1)]
    low, high = np.min(lines, axis=(0, 1)), np.max(lines, axis=(0, 1))
    size = (high - low).max()
    return ((np.array(lines) - (low + high) / 2) / size + 0.5).tolist()


PANELS = [
    ("identity", "the microsurface as it is", lambda u, v: (u, v)),
    ("stretched 5 times along u", "M = (5, 0; 0, 1)", lambda u, v: (5 * u, v)),
    ("skewed", "M = (1, 2; 0, 1)", lambda u, v: (u + 2 * v, v)),
    (
        "warped: (u, v) to (u, v + 2u⁵)",
        "M = (1, 0; 10u⁴, 1), another one at each point",
        lambda u, v: (u, v + 2 * u**5),
    ),
]


def plate_mesh():
    """A square from -1 to 1 with the unit square as its UV map."""
    import bpy

    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    mesh = bpy.data.meshes.new("Plate")
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    uv = mesh.uv_layers.new(name="UVMap").uv
    for corner, (x, y, _) in enumerate(corners):
        uv[corner].vector = ((x + 1) / 2, (y + 1) / 2)
    return mesh


def silver(panel):
    """GTR silver with a 10 x 10 grid drawn on it."""
    import bpy

    material, node, maths = gallery.nodes_of(bpy.data.materials.new(f"Silver {panel}"))
    uv = node("ShaderNodeUVMap", uv_map="UVMap").outputs["UV"]
    u, v, _ = node("ShaderNodeSeparateXYZ", uv).outputs
    near = [maths("PINGPONG", maths("MULTIPLY", axis, 10.0), 0.5) for axis in (u, v)]
    line = maths("LESS_THAN", maths("MINIMUM", *near), 0.022)
    tint = node("ShaderNodeMix", data_type="RGBA")
    sockets = {socket.identifier: socket for socket in (*tint.inputs, *tint.outputs)}
    link = material.node_tree.links.new
    link(line, sockets["Factor_Float"])
    sockets["A_Color"].default_value = (*SILVER, 1)
    sockets["B_Color"].default_value = (*(0.25 * c for c in SILVER), 1)
    metal = node(
        "conductor",
        Base_Color=sockets["Result_Color"],
        Roughness=ALPHA,
        Roughness_Is_Alpha=True,
        Tail=TAIL,
    )
    warped = {
        1: (maths("MULTIPLY", u, 5.0), v),
        2: (maths("MULTIPLY_ADD", v, 2.0, u), v),
        3: (u, maths("MULTIPLY_ADD", maths("POWER", u, 5.0), 2.0, v)),
    }
    if panel in warped:
        warp = node("warp", UV=uv, Warp=node("ShaderNodeCombineXYZ", *warped[panel]).outputs[0])
        for name in ("Tension", "Tangent"):
            link(warp.outputs[name], metal.inputs[name])
    node("ShaderNodeOutputMaterial", metal.outputs[0])
    return material


def add_body():
    """The plate's thickness and rounded rim, under and around the square."""
    import bpy

    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, -0.0705))
    body = bpy.context.object
    body.scale = (2.13, 2.13, 0.14)
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    bevel = body.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.06, 5
    body.data.shade_smooth()
    body.data.materials.append(gallery.paint("Rim", SILVER, 0.22, metallic=1))


def main():
    args = gallery.start("plate", samples=32)
    import bpy

    view = np.array((0, -math.cos(RAISED), math.sin(RAISED))) * AWAY
    gallery.studio(
        args,
        size=(540, 420),
        view=tuple(view),
        target=(0, 0, 0.03),
        height=2.16,
        lights=[
            (tuple(view * (1, -1, 1)), 110, (0.16, 0.16)),  # its mirror image is in the middle
            ((-9, -2, 5), 500, (1, 6)),
        ],
        perspective=True,
    )
    gallery.stage((0.09, 0.048, 0.03), sky=[(0, 0.02), (0.72, 0.06), (1, 0.36)], depth=55)
    bpy.data.objects["Stage"].location.z = -0.14
    add_body()
    plate = gallery.link(bpy.data.objects.new("Plate", plate_mesh()))
    cells = []
    for panel, (caption, *_) in enumerate(PANELS):
        plate.data.materials.clear()
        plate.data.materials.append(silver(panel))
        gallery.say(f"rendering: {caption}")
        cells.append(gallery.render(args, f"panel{panel}"))
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / f"{args.name}.blend"))
    rows = [
        {
            "cells": cells[i : i + 2],
            "captions": [panel[:2] for panel in PANELS[i : i + 2]],
            "insets": [sketch(panel[2]) for panel in PANELS[i : i + 2]],
        }
        for i in (0, 2)
    ]
    gallery.write_sheet(
        args,
        "Silver under one light: what is done to the microsurface shows in the highlight",
        rows,
        gap=14,
    )
    gallery.finish()


main()
