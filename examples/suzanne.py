# SPDX-License-Identifier: Apache-2.0
"""Suzanne pulls faces: shape keys, an armature that stretches, then a Subdivision Surface."""

import math

import gallery
import numpy as np

FIRST, LAST = 1, 44
COLUMNS = [
    (1, "at rest"),
    (12, "cheeks puffed"),
    (30, "stretched"),
    (44, "ears pulled"),
]


def face(rest, centre, radius):
    """1 at the centre, falling smoothly to 0, the same on both sides of the face."""
    mirrored = np.abs(rest[:, 0])[:, None] * (1, 0, 0) + rest * (0, 1, 1)
    distance = np.linalg.norm((mirrored - centre) / radius, axis=1)
    return np.exp(-(distance**2))[:, None]


def puffed(rest):
    """Cheeks and muzzle blown up like a ball."""
    centre = np.array((0, -0.25, -0.55))
    amount = face(rest, (0.22, -0.55, -0.6), (0.5, 0.6, 0.42))
    return rest + amount * (rest - centre) * (1.5, 1.0, 1.0)


def grinning(rest):
    """The corners of the mouth go out and up, the cheeks bulge."""
    corners = face(rest, (0.35, -0.6, -0.6), (0.3, 0.4, 0.25))
    cheeks = face(rest, (0.6, -0.45, -0.15), (0.3, 0.4, 0.3))
    side = np.sign(rest[:, :1])
    out = np.c_[side, 0 * side, 0 * side]
    return rest + corners * (0.3 * out + (0, 0, 0.15)) + cheeks * (0.15 * out + (0, -0.1, 0.05))


def head():
    import bpy

    bpy.ops.mesh.primitive_monkey_add(size=2)
    obj = bpy.context.object
    # Suzanne's own UV map overlaps; a bake needs one place per point of the surface.
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=math.radians(50), island_margin=0.02)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.shade_smooth()
    return obj


def add_shape_keys(obj):
    rest = np.empty((len(obj.data.vertices), 3), np.float32)
    obj.data.attributes["position"].data.foreach_get("vector", rest.ravel())
    obj.shape_key_add(name="Basis")
    for name, shape, keys in (
        ("puff", puffed(rest), [(1, 0), (12, 1), (26, 0)]),
        ("grin", grinning(rest), [(16, 0), (30, 1), (44, 0.4)]),
    ):
        key = obj.shape_key_add(name=name)
        key.data.foreach_set("co", shape.astype(np.float32).ravel())
        for frame, value in keys:
            key.value = value
            key.keyframe_insert("value", frame=frame)
    return rest


def add_armature(obj, rest):
    """Two bones up the head, one out to each ear; smooth weights by height and distance."""
    import bpy

    armature = gallery.link(bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig")))
    gallery.select(armature)
    bpy.ops.object.mode_set(mode="EDIT")
    bones = armature.data.edit_bones
    for name, start, end, parent in (
        ("jaw", (0, 0, 0), (0, 0, -1), None),
        ("crown", (0, 0, 0), (0, 0, 1), None),
        ("ear.L", (0.8, 0.1, 0.2), (1.4, 0.2, 0.35), "crown"),
        ("ear.R", (-0.8, 0.1, 0.2), (-1.4, 0.2, 0.35), "crown"),
    ):
        bone = bones.new(name)
        bone.head, bone.tail = start, end
        bone.parent = bones[parent] if parent else None
        bone.align_roll((0, -1, 0))  # turning about z is turning in the picture
    bpy.ops.object.mode_set(mode="POSE")

    up = 1 / (1 + np.exp(-6 * rest[:, 2]))
    ear = 1 / (1 + np.exp(-14 * (np.abs(rest[:, 0]) - 0.98)))
    left = rest[:, 0] > 0
    for name, weights in (
        ("jaw", (1 - up) * (1 - ear)),
        ("crown", up * (1 - ear)),
        ("ear.L", ear * left),
        ("ear.R", ear * ~left),
    ):
        group = obj.vertex_groups.new(name=name)
        for index, weight in enumerate(weights):
            if weight > 1e-3:
                group.add([index], float(weight), "REPLACE")

    def pose(frame, **bones):
        for name in ("jaw", "crown", "ear.L", "ear.R"):
            bone = armature.pose.bones[name]
            bone.rotation_mode = "XYZ"
            turn, scale = bones.get(name.replace(".", "_"), ((0, 0, 0), (1, 1, 1)))
            bone.rotation_euler = [math.radians(angle) for angle in turn]
            bone.scale = scale
            bone.keyframe_insert("rotation_euler", frame=frame)
            bone.keyframe_insert("scale", frame=frame)

    still = (0, 0, 0)
    pose(1)
    pose(12)
    longer = (still, (0.6, 1.75, 0.6))
    pose(30, jaw=longer, crown=longer)
    pose(
        44,
        crown=((0, 0, 14), (1, 1.15, 1)),
        ear_L=((0, 0, 35), (1, 1.7, 1)),
        ear_R=((0, 0, -50), (1, 1.7, 1)),
    )
    bpy.ops.object.mode_set(mode="OBJECT")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = armature


def main():
    args = gallery.start("suzanne")
    import bpy

    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FIRST, LAST
    gallery.studio(
        args,
        size=(245, 270),
        view=(-2.2, -11.5, 1.2),
        target=(0, -0.1, 0.02),
        height=3.6,
        lights=[
            ((-2.6, -9, 0.6), 1100, (0.5, 0.5)),
            ((-1.5, -3, 9), 1100, (0.7, 0.7)),
            ((7, 3, 0.5), 200, (0.6, 6)),
            ((-7, 3.5, 1), 150, (0.6, 6)),
        ],
    )
    obj = head()
    rest = add_shape_keys(obj)
    add_armature(obj, rest)
    # The picture has a finer surface than the viewport; the bake has to measure the one rendered.
    subdivision = obj.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels, subdivision.render_levels = 1, 3
    # The default folds small UV faces over at island borders.
    subdivision.uv_smooth = "PRESERVE_CORNERS"
    obj.data.materials.append(gallery.paint("Paint", (0.03, 0.2, 0.85), 0.42, metallic=1))
    gallery.present(
        obj,
        args,
        "Suzanne pulls faces (shape keys, armature, then Subdivision Surface)",
        COLUMNS,
        size=1024,
    )


main()
