# SPDX-License-Identifier: Apache-2.0
"""A rubber balloon under Blender's cloth simulation: inflated, squeezed at the waist and pulled."""

import math

import gallery
import numpy as np
import solids

SEGMENTS, RINGS = 96, 80
WAIST = -0.1
FIRST, LAST = 1, 50
COLUMNS = [
    (1, "at rest"),
    (13, "inflated"),
    (24, "squeezed"),
    (34, "squeezed more"),
    (50, "and pulled"),
]
# Outline from the top to the lip: radius, height.
OUTLINE = np.array(
    [
        (0, 1),
        (0.38, 0.925),
        (0.71, 0.71),
        (0.93, 0.38),
        (1, 0),
        (0.955, -0.36),
        (0.82, -0.68),
        (0.61, -0.95),
    ]
    + [(0.40, -1.16), (0.235, -1.32), (0.15, -1.43), (0.125, -1.52), (0.165, -1.60)]
)


def balloon_mesh():
    """A surface of revolution; u runs around it with the seam behind, v from the lip to the top."""
    import bpy

    before = OUTLINE[1] * (-1, 1)
    outline = solids.smooth_curve(OUTLINE, RINGS + 1, before)
    angle = (np.arange(SEGMENTS) / SEGMENTS + 0.25) * 2 * math.pi
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = [np.c_[radius * around, np.full(SEGMENTS, height)] for radius, height in outline[1:]]
    positions = np.vstack([[(0, 0, 1)], *rings])

    def vert(ring, segment):
        return 1 + (ring - 1) * SEGMENTS + segment % SEGMENTS

    faces, uv = [], []
    for s in range(SEGMENTS):
        faces.append((0, vert(1, s), vert(1, s + 1)))
        uv += [(s + 0.5, 0), (s, 1), (s + 1, 1)]
    for r in range(1, RINGS):
        for s in range(SEGMENTS):
            faces.append((vert(r, s), vert(r + 1, s), vert(r + 1, s + 1), vert(r, s + 1)))
            uv += [(s, r), (s, r + 1), (s + 1, r + 1), (s + 1, r)]
    uv = np.array(uv) / (SEGMENTS, RINGS)
    uv[:, 1] = 1 - uv[:, 1]
    mesh = bpy.data.meshes.new("Balloon")
    mesh.from_pydata(positions.tolist(), [], faces)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv.astype(np.float32).ravel())
    mesh.shade_smooth()
    return mesh, positions


def held_shape(rest, waist, length, drop):
    """Where the held vertices go: the waist to a radius of `waist`, the neck down by `drop`."""
    z = rest[:, 2] - WAIST
    shape = rest.copy()
    shape[:, :2] *= (waist + (1.45 - waist) * (1 - np.exp(-((z / 0.5) ** 2))))[:, None]
    shape[:, 2] = WAIST + z * length
    neck = rest[:, 2] < -1.35
    shape[neck] = rest[neck] - (0, 0, drop)
    return shape


def add_animation(obj, rest):
    """Shape keys move the vertices that the pin group holds; cloth moves the others."""
    obj.shape_key_add(name="Basis")
    for name, shape, keys in (
        ("inflated", held_shape(rest, 1.45, 1.5, 0.25), [(1, 0), (12, 1), (16, 1), (32, 0)]),
        ("squeezed", held_shape(rest, 0.35, 1.60, 0.30), [(16, 0), (32, 1), (34, 1), (48, 0)]),
        ("pulled", held_shape(rest, 0.28, 2.20, 1.10), [(34, 0), (48, 1)]),
    ):
        key = obj.shape_key_add(name=name)
        key.data.foreach_set("co", shape.astype(np.float32).ravel())
        for frame, value in keys:
            key.value = value
            key.keyframe_insert("value", frame=frame)
    waist = 0.9 * np.exp(-(((rest[:, 2] - WAIST) / 0.34) ** 2))
    neck = np.clip((-rest[:, 2] - 1.38) / 0.12, 0, 1)
    held = obj.vertex_groups.new(name="held")
    for index, weight in enumerate(np.maximum(waist, neck)):
        if weight > 0.002:
            held.add([index], float(weight), "REPLACE")


def add_cloth(obj):
    """Soft rubber that hardly resists being squeezed, so that the waist does not buckle."""
    cloth = obj.modifiers.new("Cloth", "CLOTH")
    rubber = cloth.settings
    rubber.quality = 6
    rubber.tension_stiffness, rubber.compression_stiffness, rubber.shear_stiffness = 4, 0.05, 1
    rubber.tension_damping = rubber.compression_damping = rubber.shear_damping = 2
    rubber.bending_stiffness = 10
    rubber.air_damping = 2
    rubber.effector_weights.gravity = 0
    rubber.vertex_group_mass = "held"
    rubber.use_pressure = True
    for frame, pressure in ((1, 0), (12, 60)):
        rubber.uniform_pressure_force = pressure
        rubber.keyframe_insert("uniform_pressure_force", frame=frame)
    cloth.collision_settings.use_collision = False
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = FIRST, LAST
    return cloth


def bake_cloth(obj, cloth):
    """An unbaked simulation depends on the frame it was started from; a baked one does not."""
    import bpy

    gallery.say(f"simulating cloth, frames {FIRST} to {LAST}")
    with bpy.context.temp_override(object=obj, active_object=obj, point_cache=cloth.point_cache):
        bpy.ops.ptcache.bake(bake=True)


def main():
    args = gallery.start("balloon")
    import bpy

    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FIRST, LAST
    gallery.studio(
        args,
        size=(200, 286),
        view=(0, -12, 1.0),
        target=(0, 0, -0.56),
        height=4.65,
        lights=[
            ((-2.5, -8, 4), 1300, (0.7, 0.7)),
            ((5, -5, 1.2), 350, (0.5, 0.5)),
            ((7, 3, 0.5), 500, (0.6, 6)),
            ((-7, 3.5, 1), 400, (0.6, 6)),
        ],
    )
    mesh, rest = balloon_mesh()
    mesh.materials.append(gallery.paint("Rubber", (0.9, 0.05, 0.06), 0.47, metallic=1))
    obj = gallery.link(bpy.data.objects.new("Balloon", mesh))
    add_animation(obj, rest)
    bake_cloth(obj, add_cloth(obj))
    gallery.present(
        obj,
        args,
        "A balloon is inflated, squeezed at the waist and pulled (Blender's cloth simulation)",
        COLUMNS,
        size=512,
        lines=(24, 20),
    )


main()
