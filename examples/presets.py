# SPDX-License-Identifier: Apache-2.0
"""Every preset on a pill at rest and on the same pill wrung and pulled: one picture.

    python presets.py --extension ltmd.zip --out FOLDER

presets.py writes the cells and FOLDER/sheet.json; contact_sheet.py composes them.
"""

import importlib
import json
import math

import gallery
import numpy as np

SIZE = (196, 172)
AROUND, ALONG = 128, 160
HALF, RADIUS = 0.95, 0.5


def pill():
    """Positions [ALONG + 1, AROUND, 3] of a round-ended rod along z."""
    angle = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    # Even steps of arc length: the first and last quarter circle, and the straight part.
    cap = RADIUS * np.pi / 2
    straight = 2 * (HALF - RADIUS)
    arc = np.linspace(1e-3, straight + 2 * cap - 1e-3, ALONG + 1)
    low, high = arc < cap, arc > cap + straight
    turn = np.where(low, arc - cap, np.where(high, arc - cap - straight, 0)) / RADIUS
    radius = RADIUS * np.cos(turn)
    z = np.clip(arc - cap - straight / 2, -straight / 2, straight / 2) + RADIUS * np.sin(turn)
    return np.stack(
        [
            radius[:, None] * np.cos(angle),
            radius[:, None] * np.sin(angle),
            np.broadcast_to(z[:, None], (ALONG + 1, AROUND)),
        ],
        axis=-1,
    )


def wrung(points):
    """The upper part is blown up, the middle wrung to a waist and pulled, the foot flattened."""
    x, y, z = np.moveaxis(points, -1, 0)
    t = z / HALF
    waist = np.exp(-((t + 0.12) ** 2) / 0.07)
    wide = 1 + 0.42 * np.exp(-((t - 0.62) ** 2) / 0.13) + 0.2 * np.exp(-((t + 0.85) ** 2) / 0.06)
    radial = wide * (1 - 0.56 * waist)
    twist = 1.5 * np.tanh(2.4 * (t + 0.12))
    c, s = np.cos(twist), np.sin(twist)
    height = z * (1 + 0.05 * t) + 0.1 * np.tanh(4 * (t + 0.12))
    return np.stack(
        [radial * (c * x - s * y) + 0.16 * t * t, radial * (s * x + c * y), height], axis=-1
    )


def rod(name, place):
    import bpy

    rest = pill()
    mesh = bpy.data.meshes.new(name)
    index = np.arange((ALONG + 1) * AROUND).reshape(ALONG + 1, AROUND)
    right = np.roll(index, -1, axis=1)
    quads = np.stack([index[:-1], right[:-1], right[1:], index[1:]], axis=-1).reshape(-1, 4)
    faces = [*quads.tolist(), index[0, ::-1].tolist(), index[-1].tolist()]
    mesh.from_pydata(rest.reshape(-1, 3).tolist(), [], faces)
    uv = mesh.uv_layers.new(name="UVMap")
    u, v = np.meshgrid(np.arange(AROUND + 1) / AROUND, np.arange(ALONG + 1) / ALONG)
    grid = np.stack([u, v], axis=-1)
    corners = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    ends = [np.zeros((AROUND, 2)), np.ones((AROUND, 2))]
    uv.uv.foreach_set(
        "vector", np.concatenate([corners.reshape(-1, 2), *ends]).astype(np.float32).ravel()
    )
    mesh.shade_smooth()
    obj = gallery.link(bpy.data.objects.new(name, mesh))
    obj.location = place
    return obj, rest


def environment():
    """A studio to be seen in metal: dark below, bright above, a horizon."""
    import bpy

    tree = bpy.context.scene.world.node_tree
    direction = tree.nodes.new("ShaderNodeTexCoord")
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    half = tree.nodes.new("ShaderNodeMath")
    half.operation, half.inputs[1].default_value, half.inputs[2].default_value = (
        "MULTIPLY_ADD",
        0.5,
        0.5,
    )
    tree.links.new(direction.outputs["Generated"], parts.inputs[0])
    tree.links.new(parts.outputs["Z"], half.inputs[0])
    tree.links.new(half.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], tree.nodes["Background"].inputs["Color"])
    elements = ramp.color_ramp.elements
    for _ in range(2):
        elements.new(0.5)
    for element, (at, colour) in zip(
        elements,
        (
            (0.0, (0.03, 0.029, 0.028)),
            (0.46, (0.08, 0.078, 0.076)),
            (0.52, (0.25, 0.24, 0.235)),
            (1.0, (0.58, 0.56, 0.55)),
        ),
        strict=True,
    ):
        element.position, element.color = at, (*colour, 1)


def main():
    args = gallery.start("presets")
    import bpy

    presets = importlib.import_module(f"{gallery.EXTENSION}.presets")
    gallery.studio(
        args,
        SIZE,
        view=(0, -9, 2.2),
        target=(0.03, 0, 0.02),
        height=2.4,
        lights=(
            ((-4.5, -3.5, 3.5), 210, (0.9, 5)),
            ((4.8, -2.2, 2.0), 110, (0.5, 5)),
            ((0.5, -1, 6), 110, (4, 1.5)),
        ),
    )
    environment()
    plain = gallery.paint("Material", (0.03, 0.22, 0.2), 0.36)
    objects = []
    for name, x in (("Rest", -0.76), ("Wrung", 0.52)):
        obj, rest = rod(name, (x, 0, 0))
        obj.data.materials.append(plain)
        obj.rotation_euler = (0, math.radians(4 if x < 0 else -5), 0)
        objects.append(obj)
    wrung_rod = objects[1]
    wrung_rod.shape_key_add(name="Basis")
    key = wrung_rod.shape_key_add(name="Wrung")
    key.data.foreach_set("co", wrung(rest).astype(np.float32).ravel())
    key.value = 1
    gallery.select(objects[0])
    cells = []
    for heading, part in presets.GROUPS:
        for name, preset in part.items():
            # Afresh: a preset keeps the base colour that it does not name.
            bpy.ops.ltmd.remove(object_name="Rest")
            for obj in objects:
                bpy.ops.ltmd.setup(object_name=obj.name)
            # Metals set the colour alone, whatever the highlight was before.
            if heading == "Metals":
                bpy.ops.ltmd.preset(preset="BRUSHED_ALUMINIUM")
            bpy.ops.ltmd.preset(preset=name)
            path = args.out / "cells" / f"{name}.png"
            bpy.context.scene.render.filepath = str(path)
            bpy.ops.render.render(write_still=True)
            gallery.say(preset.label)
            cells.append([preset.label, str(path)])
    sheet = {
        "title": "Presets: at rest, and wrung and pulled",
        "columns": 5,
        "cells": cells,
    }
    (args.out / "sheet.json").write_text(json.dumps(sheet, indent=1))
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / "presets.blend"))
    gallery.finish()


if __name__ == "__main__":
    main()
