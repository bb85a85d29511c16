# SPDX-License-Identifier: Apache-2.0
"""What the example scenes share: the installed extension, the studio, the cells of the sheet.

A scene module calls start() before anything else, because Blender reads the user folder when bpy
is imported. The cells and a description of the sheet go to OUT; contact_sheet.py composes them.
"""

import argparse
import importlib
import json
import math
import os
import sys
import time
from pathlib import Path

EXTENSION = "bl_ext.user_default.ltmd"
LARGEST_AREA = 3.0
# Blue, white, orange: told apart by everyone, and white is "as at rest". sRGB, in even steps of the
# logarithm of the area.
RAMP = [
    (0.10, 0.25, 0.62),
    (0.36, 0.62, 0.86),
    (0.93, 0.93, 0.92),
    (0.97, 0.62, 0.28),
    (0.72, 0.16, 0.06),
]
_began = time.perf_counter()


def say(text):
    # Blender talks on stdout.
    print(f"      {time.perf_counter() - _began:5.1f} s  {text}", file=sys.stderr, flush=True)


def start(name, samples=128):
    """The arguments; bpy with the extension installed in a clean user folder under OUT."""
    parser = argparse.ArgumentParser(prog=f"{name}.py")
    parser.add_argument("--extension", type=Path, required=True, help="the extension's zip")
    parser.add_argument("--out", type=Path, required=True, help="folder for everything made here")
    parser.add_argument("--samples", type=int, default=samples)
    parser.add_argument("--scale", type=float, default=1.0, help="size of the cells")
    args = parser.parse_args()
    args.name = name
    args.out = args.out.resolve()
    args.out.mkdir(parents=True, exist_ok=True)
    os.environ["BLENDER_USER_RESOURCES"] = str(args.out / "blender_user")
    import bpy

    bpy.utils.expose_bundled_modules()
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, app_template="")
    bpy.ops.extensions.package_install_files(
        filepath=str(args.extension.resolve()), repo="user_default", enable_on_install=True
    )
    if not hasattr(bpy.types, "LTMD_OT_bake"):
        sys.exit(f"error: {args.extension} was installed, but its operators are not there")
    return args


def finish():
    """Ends the process at once: tearing down bpy as a module can crash after all is written."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


def link(data_block_or_object):
    import bpy

    bpy.context.scene.collection.objects.link(data_block_or_object)
    return data_block_or_object


def aim(obj, place, target):
    from mathutils import Vector

    obj.location = place
    obj.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()


def studio(args, size, view, target, height, lights, perspective=False):
    """Camera, lights and a renderer with no denoiser and no filter that would touch a highlight.

    height: what the picture shows at the target. lights: place, power, (width, length) and
    perhaps a colour.
    """
    import bpy

    scene = bpy.context.scene
    camera = link(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    width = height * max(1, size[0] / size[1])
    if perspective:
        camera.data.angle = 2 * math.atan(width / 2 / math.dist(view, target))
    else:
        camera.data.type = "ORTHO"
        camera.data.ortho_scale = width
    aim(camera, view, target)
    scene.camera = camera
    for place, power, (width, length), *colour in lights:
        lamp = bpy.data.lights.new("Light", "AREA")
        lamp.color = colour[0] if colour else (1, 1, 1)
        lamp.energy, lamp.shape, lamp.size, lamp.size_y = power, "RECTANGLE", width, length
        aim(link(bpy.data.objects.new("Light", lamp)), place, target)
    world = scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.045, 0.055, 0.075, 1)

    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = args.samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.blur_glossy = 0
    scene.cycles.max_bounces = 1
    scene.cycles.sample_clamp_indirect = 1
    # Four lights for a small object: the light tree's guesses only add fireflies.
    scene.cycles.use_light_tree = False
    scene.render.resolution_x, scene.render.resolution_y = (round(args.scale * n) for n in size)
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Standard"


def paint(name, colour, roughness, metallic=0.0, ior=1.5):
    """A material as an artist would make it: one Principled BSDF, nothing of LTMD."""
    import bpy

    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*colour, 1)
    inputs["Metallic"].default_value = metallic
    inputs["IOR"].default_value = ior
    inputs["Roughness"].default_value = roughness
    return material


def nodes_of(owner):
    """The owner's node tree emptied: owner, node(kind, *sources, **settings), maths(operation, …).

    A source is a socket to link or a value, for the node's inputs in their order. A kind that is a
    module of the extension's folder nodes, in small letters, gives that group, and its settings are
    its inputs by name.
    """
    import bpy

    owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()

    def give(socket, source):
        if isinstance(source, bpy.types.NodeSocket):
            tree.links.new(source, socket)
        elif source is not None:
            socket.default_value = source

    def node(kind, *sources, **settings):
        if kind.islower():
            groups = importlib.import_module(f"{EXTENSION}.nodes")
            made = groups.group_node(tree, importlib.import_module(f"{EXTENSION}.nodes.{kind}"))
            for name, source in settings.items():
                give(made.inputs[name.replace("_", " ")], source)
        else:
            made = tree.nodes.new(kind)
            for key, value in settings.items():
                setattr(made, key, value)
        for socket, source in zip(made.inputs, sources, strict=False):
            give(socket, source)
        return made

    def maths(operation, *sources, **settings):
        return node("ShaderNodeMath", *sources, operation=operation, **settings).outputs[0]

    return owner, node, maths


def stage(colour, sky, depth=6.0):
    """A matt floor at z = 0 that rises to a wall behind, under a sky of (height, grey).

    Nothing is clamped.
    """
    import bpy

    scene = bpy.context.scene
    bend = [i * math.pi / 48 for i in range(25)]
    outline = [(-60, 0), *((depth + 4 * math.sin(t), 4 - 4 * math.cos(t)) for t in bend)]
    outline.append((depth + 4, 60))
    positions = [(x, y, z) for y, z in outline for x in (-60, 60)]
    faces = [(i, i + 1, i + 3, i + 2) for i in range(0, len(positions) - 2, 2)]
    mesh = bpy.data.meshes.new("Stage")
    mesh.from_pydata(positions, [], faces)
    mesh.shade_smooth()
    link(bpy.data.objects.new("Stage", mesh))
    matt, node, _ = nodes_of(bpy.data.materials.new("Stage"))
    node("ShaderNodeOutputMaterial", node("ShaderNodeBsdfDiffuse", (*colour, 1)).outputs[0])
    mesh.materials.append(matt)
    _, node, _ = nodes_of(scene.world)
    up = node("ShaderNodeSeparateXYZ", node("ShaderNodeTexCoord").outputs["Generated"]).outputs["Z"]
    ramp = node("ShaderNodeValToRGB", up)
    elements = ramp.color_ramp.elements
    while len(elements) < len(sky):
        elements.new(1)
    for element, (height, grey) in zip(elements, sky, strict=True):
        element.position = height
        element.color = (0.92 * grey, grey, 1.15 * grey, 1)
    node("ShaderNodeOutputWorld", node("ShaderNodeBackground", ramp.outputs["Color"]).outputs[0])
    scene.cycles.shading_system = True
    # A smooth sky needs no samples of its own: the lamps get them all.
    scene.world.cycles.sampling_method = "NONE"
    scene.cycles.sample_clamp_indirect = 0
    # Light that metal throws on the floor would be noise; highlights do not depend on it.
    scene.cycles.caustics_reflective = False
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.render.film_transparent = False


def linear(srgb):
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in srgb]


def area_colours(files, first, last, lines=0):
    """A material that shows the area ratio t11 · t22 of baked images, read by stock nodes."""
    import bpy

    material, node, maths = nodes_of(bpy.data.materials.new("Baked tension"))
    image = bpy.data.images.load(str(files[first]))
    image.source = "SEQUENCE"
    image.colorspace_settings.is_data = True
    texture = node("ShaderNodeTexImage", image=image)
    texture.image_user.frame_duration = last
    texture.image_user.frame_start = 1
    texture.image_user.use_auto_refresh = True
    t = node("ShaderNodeSeparateXYZ", texture.outputs["Color"]).outputs
    half = math.log(LARGEST_AREA)
    ratio = maths("LOGARITHM", maths("MULTIPLY", t[0], t[2]), math.e)
    ramp = node("ShaderNodeValToRGB", maths("MULTIPLY_ADD", ratio, 0.5 / half, 0.5))
    elements = ramp.color_ramp.elements
    while len(elements) < len(RAMP):
        elements.new(0.5)
    for index, colour in enumerate(RAMP):
        elements[index].position = index / (len(RAMP) - 1)
        elements[index].color = (*linear(colour), 1)
    # A little darker where the surface turns away, so that its form can be read.
    facing = node("ShaderNodeLayerWeight", 0.5).outputs["Facing"]
    light = maths("MULTIPLY_ADD", maths("POWER", facing, 2.0), -0.55, 1.0)
    if lines:
        # Lines drawn on the surface at rest show which way it was stretched.
        uv = node("ShaderNodeSeparateXYZ", node("ShaderNodeTexCoord").outputs["UV"]).outputs
        near = [
            maths("PINGPONG", maths("MULTIPLY", axis, float(count)), 0.5)
            for axis, count in zip(uv, lines, strict=False)
        ]
        line = maths("LESS_THAN", maths("MINIMUM", *near), 0.03)
        light = maths("MULTIPLY", light, maths("MULTIPLY_ADD", line, -0.3, 1.0))
    emission = node("ShaderNodeEmission", ramp.outputs["Color"], light)
    node("ShaderNodeOutputMaterial", emission.outputs[0])
    return material


def stretch_range(file):
    """Smallest and largest principal stretch in a baked image."""
    import ltmd

    pixels = ltmd.read_exr(str(file))[..., :3].reshape(-1, 3)
    covered = pixels[(pixels != (1, 0, 1)).any(axis=1)]
    stretch = ltmd.stretch(covered if len(covered) else pixels)
    return float(stretch[:, 1].min()), float(stretch[:, 0].max())


def stretch_words(low, high):
    low, high = f"{low:.0%}", f"{high:.0%}"
    return "no stretch" if low == high == "100%" else f"stretched to {low} – {high}"


def bake(obj, args, first, last, size):
    """Sets LTMD up, bakes and turns the material to the images; the frame -> file dictionary."""
    import bpy

    select(obj)
    bpy.ops.ltmd.setup()
    say(f"baking frames {first} to {last} into {size} x {size} images")
    began = time.perf_counter()
    folder = args.out / "tension"
    bpy.ops.ltmd.bake(frames=f"{first}-{last}", size=size, directory=str(folder))
    files = {n: folder / f"{obj.name}_tension.{n:04d}.exr" for n in range(first, last + 1)}
    missing = [str(path) for path in files.values() if not path.exists()]
    if missing:
        sys.exit(f"error: the bake left out {len(missing)} files, the first is {missing[0]}")
    seconds = time.perf_counter() - began
    say(f"baked {len(files)} images in {seconds:.1f} s")
    return files


def set_strength(material, value):
    """How much of the deformation the highlights follow: 0 is the material without LTMD."""
    lobe = material.node_tree.nodes["LTMD Glossy"]
    lobe.inputs["Strength"].default_value = value


def select(obj):
    import bpy

    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj


def render_row(args, row, frames, words):
    """One picture per frame; their paths."""
    import bpy

    say(f"rendering {len(frames)} frames, {words}")
    paths = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        paths.append(render(args, f"{row}_{frame:04d}"))
    return paths


def render(args, name):
    """The scene as it is now, as a cell of the sheet; its path."""
    import bpy

    path = args.out / "cells" / f"{name}.png"
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return str(path)


def present(obj, args, title, columns, size, lines=0):
    """Saves the scene, bakes its frames at size x size, renders the sheet's cells, and ends."""
    import bpy

    scene = bpy.context.scene
    first, last = scene.frame_start, scene.frame_end
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / f"{args.name}.blend"))
    files = bake(obj, args, first, last, size)
    three_rows(obj, args, title, columns, files, first, last, lines)
    finish()


def three_rows(obj, args, title, columns, files, first, last, lines):
    """Renders plain, LTMD and measured rows and writes the description of the sheet.

    columns: (frame, caption) in the order of the sheet.
    """
    import bpy

    scene = bpy.context.scene
    frames = [frame for frame, _ in columns]
    ranges = {frame: stretch_range(files[frame]) for frame in frames}
    for frame, caption in columns:
        low, high = ranges[frame]
        say(f"frame {frame:3d}, {caption}: principal stretch {low:.2f} to {high:.2f}")
    material = obj.active_material
    set_strength(material, 0)
    rows = [
        {
            "name": "Plain material",
            "note": "same roughness\neverywhere",
            "captions": [[caption, stretch_words(*ranges[frame])] for frame, caption in columns],
            "cells": render_row(args, "plain", frames, "plain material"),
        }
    ]
    set_strength(material, 1)
    rows.append(
        {
            "name": "With LTMD",
            "note": "stretched: glossier\nsqueezed: duller",
            "cells": render_row(args, "ltmd", frames, "with LTMD"),
        }
    )
    bpy.ops.wm.save_mainfile()

    obj.active_material = area_colours(files, first, last, lines)
    scene.cycles.samples = 16
    rows.append(
        {
            "name": "Measured",
            "note": "change of area, from\nthe baked images",
            "cells": render_row(args, "measured", frames, "false colours"),
        }
    )
    legend = {
        "ramp": RAMP,
        "words": ["a third of the area", "as at rest", "three times the area"],
    }
    write_sheet(args, title, rows, legend=legend)


def write_sheet(args, title, rows, **more):
    """What contact_sheet.py composes: rows of name, note, cells (paths), captions and insets."""
    sheet = {"title": title, "rows": rows, **more}
    (args.out / "sheet.json").write_text(json.dumps(sheet, indent=1))
