# SPDX-License-Identifier: Apache-2.0
"""Show Tension: a material and the three views of its deformation, on two shapes.

python tension_views.py --extension ltmd.zip --out FOLDER
"""

import json

import gallery
import numpy as np
import presets

SIZE = (300, 190)
AROUND, ALONG = 192, 96


def torus(name):
    """A ring of radius 1, and the same one pulled out to a drop."""
    import bpy

    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, AROUND + 1), np.linspace(0, 2 * np.pi, ALONG + 1), indexing="ij"
    )
    ring = 1 + 0.42 * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), 0.42 * np.sin(v)], axis=-1)[:-1, :-1]
    index = np.arange(AROUND * ALONG).reshape(AROUND, ALONG)
    right, up = np.roll(index, -1, axis=0), np.roll(index, -1, axis=1)
    quads = np.stack([index, right, np.roll(right, -1, axis=1), up], axis=-1).reshape(-1, 4)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.reshape(-1, 3).tolist(), [], quads.tolist())
    grid = np.stack([u, v], axis=-1) / (2 * np.pi)
    corners = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", corners.astype(np.float32).ravel())
    mesh.shade_smooth()
    obj = gallery.link(bpy.data.objects.new(name, mesh))
    x, y, z = np.moveaxis(points, -1, 0)
    pulled = np.stack([1.5 * x + 0.25 * x * x, 0.85 * y * (1 - 0.3 * x), z * (1 + 0.4 * x)], -1)
    return obj, pulled


def main():
    args = gallery.start("tension_views")
    import bpy

    gallery.studio(
        args,
        SIZE,
        view=(0, -8, 4.2),
        target=(0, 0, 0),
        height=2.4,
        lights=(
            ((-4.5, -3.5, 3.5), 260, (0.9, 5)),
            ((4.8, -2.2, 2.0), 140, (0.5, 5)),
            ((0.5, -1, 6), 160, (4, 1.5)),
        ),
    )
    presets.environment()
    ring, pulled = torus("Ring")
    rod, rest = presets.rod("Rod", (0, 0, 0))
    rod.rotation_euler.y = 1.35
    rod.scale = (1.25, 1.25, 1.25)
    ring.scale = (0.72, 0.72, 0.72)
    ring.location.x = -0.22
    material = gallery.paint("Material", (0.05, 0.12, 0.3), 0.4)
    cells = []
    for obj, shape in ((ring, pulled), (rod, presets.wrung(rest))):
        obj.data.materials.append(material)
        obj.shape_key_add(name="Basis")
        key = obj.shape_key_add(name="Deformed")
        key.data.foreach_set("co", np.asarray(shape, np.float32).ravel())
        key.value = 1
        gallery.select(obj)
        bpy.ops.ltmd.setup()
        bpy.ops.ltmd.preset(preset="RUBBER_BALLOON")
        for other in (ring, rod):
            other.hide_render = other != obj
        for caption in ("Material", "Magnitude", "Area", "Directions"):
            if caption != "Material":
                bpy.ops.ltmd.show_tension(show="TENSION", mode=caption.upper())
            path = args.out / "cells" / f"{obj.name}_{caption}.png"
            bpy.context.scene.render.filepath = str(path)
            bpy.ops.render.render(write_still=True)
            gallery.say(f"{obj.name}, {caption}")
            cells.append([caption, str(path)])
        bpy.ops.ltmd.show_tension(show="MATERIAL")
    sheet = {
        "title": "Show Tension: grey at rest, red stretched, blue squeezed, purple both",
        "columns": 4,
        "cells": cells,
    }
    (args.out / "sheet.json").write_text(json.dumps(sheet, indent=1))
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / "tension_views.blend"))
    gallery.finish()


if __name__ == "__main__":
    main()
