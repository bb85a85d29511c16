# SPDX-License-Identifier: Apache-2.0
"""A metal bottle with one small lamp, for each Tail and three sizes of the highlight.

    python tails.py --extension ltmd.zip --out FOLDER

tails.py writes the cells and FOLDER/sheet.json; contact_sheet.py composes them.
"""

import importlib
import math

import gallery
import numpy as np
import presets

TAILS = (1.0, 1.5, 2.0, 3.0, 4.0)
ROUGHNESSES = (0.18, 0.32, 0.48)
NOTES = {
    1.0: "long glow",
    1.5: "glow",
    2.0: "GGX, as stock nodes",
    3.0: "little glow",
    4.0: "hardly any",
}
SEGMENTS = 128
# Outline from the foot to the lip: radius, height. Corners are rounded off.
OUTLINE = [
    (0.0, -1.0),
    (0.5, -1.0),
    (0.78, -0.85),
    (0.95, -0.3),
    (0.8, 0.25),
    (0.3, 0.45),
    (0.2, 0.75),
    (0.22, 1.0),
    (0.33, 1.12),
    (0.27, 1.12),
    (0.16, 1.0),
    (0.14, 0.7),
]


def rounded(points, times):
    """Chaikin's corner cutting."""
    points = np.array(points, float)
    for _ in range(times):
        quarter = 0.75 * points[:-1] + 0.25 * points[1:]
        three = 0.25 * points[:-1] + 0.75 * points[1:]
        inner = np.stack([quarter, three], axis=1).reshape(-1, 2)
        points = np.vstack([points[:1], inner, points[-1:]])
    return points


def bottle():
    import bpy

    outline = rounded(OUTLINE, 4)[1:]
    angle = np.arange(SEGMENTS) / SEGMENTS * 2 * math.pi
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = [np.c_[radius * around, np.full(SEGMENTS, height)] for radius, height in outline]
    faces = [
        (r * SEGMENTS + s, r * SEGMENTS + t, (r + 1) * SEGMENTS + t, (r + 1) * SEGMENTS + s)
        for r in range(len(rings) - 1)
        for s in range(SEGMENTS)
        for t in [(s + 1) % SEGMENTS]
    ]
    faces.append(tuple(range(SEGMENTS - 1, -1, -1)))
    mesh = bpy.data.meshes.new("Bottle")
    mesh.from_pydata(np.vstack(rings).tolist(), [], faces)
    mesh.shade_smooth()
    return gallery.link(bpy.data.objects.new("Bottle", mesh))


def metal(obj):
    """A material of one LTMD Conductor; return the node."""
    import bpy

    nodes = importlib.import_module(f"{gallery.EXTENSION}.nodes")
    conductor = importlib.import_module(f"{gallery.EXTENSION}.nodes.conductor")
    metals = importlib.import_module(f"{gallery.EXTENSION}.metals")
    material = bpy.data.materials.new("Gold")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = nodes.group_node(tree, conductor)
    gold = metals.METALS["Gold"]
    node.inputs["Base Color"].default_value = (*gold.base_color(), 1)
    node.inputs["Edge Tint"].default_value = (*gold.edge_tint(), 1)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    obj.data.materials.append(material)
    return node


def main():
    args = gallery.start("tails")
    import bpy

    gallery.studio(
        args,
        size=(190, 224),
        view=(0, -9, 1.6),
        target=(0, 0, 0.04),
        height=2.5,
        lights=[((-3.5, -6, 4.5), 380, (0.35, 0.35)), ((6, 1.5, 1), 70, (0.4, 4))],
    )
    presets.environment()
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.4
    bpy.context.scene.cycles.shading_system = True
    obj = bottle()
    node = metal(obj)
    rows = []
    for roughness in ROUGHNESSES:
        cells = []
        for tail in TAILS:
            node.inputs["Roughness"].default_value = roughness
            node.inputs["Tail"].default_value = tail
            cells.append(gallery.render(args, f"{roughness:.2f}_{tail:.1f}"))
        gallery.say(f"Roughness {roughness:g}")
        note = "the size of the\nhighlight's core"
        rows.append({"name": f"Roughness {roughness:g}", "note": note, "cells": cells})
    rows[0]["captions"] = [[f"Tail {tail:g}", NOTES[tail]] for tail in TAILS]
    gallery.write_sheet(args, "Tail: how far the highlight glows around its core", rows)
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / "tails.blend"))
    gallery.finish()


if __name__ == "__main__":
    main()
