# SPDX-License-Identifier: Apache-2.0
"""What random normals render: a squeeze beyond the closures' roughness, and distributions and glass
that have no closure.

    python beyond_lobes.py --extension ltmd.zip --out FOLDER

beyond_lobes.py writes the cells and FOLDER/sheet.json; contact_sheet.py composes them.
"""

import json
import math

import gallery

SIZE = (196, 186)
SQUEEZE = 0.35
STRETCHED = (2.2, 0, 0.9)


def ball():
    import bpy

    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=64, radius=1)
    bpy.ops.object.shade_smooth()
    obj = bpy.context.object
    obj.rotation_euler = (math.radians(35), 0, math.radians(20))
    return obj


def material(obj, name, kind, **settings):
    """The ball in a node of a group, or in a stock node where its name says so."""
    import bpy

    made, node, _ = gallery.nodes_of(bpy.data.materials.new(name))
    tangent = node("ShaderNodeTangent", direction_type="UV_MAP").outputs[0]
    if kind.islower():
        shader = node(kind, Tangent=tangent, Roughness_Is_Alpha=True, **settings)
    else:
        shader = node(kind)
        for socket, value in dict(settings, Tangent=tangent).items():
            if socket == "Tangent":
                made.node_tree.links.new(value, shader.inputs[socket])
            else:
                shader.inputs[socket].default_value = value
    node("ShaderNodeOutputMaterial", shader.outputs[0])
    obj.data.materials.clear()
    obj.data.materials.append(made)


def windows():
    """A room as the world: large windows, and bars behind the glass. Small lamps would be noise."""
    import bpy

    owner, node, maths = gallery.nodes_of(bpy.context.scene.world)
    direction = node("ShaderNodeTexCoord").outputs["Generated"]

    def along(vector, low, high, strength):
        cosine = node("ShaderNodeVectorMath", direction, vector, operation="DOT_PRODUCT")
        edge = node("ShaderNodeMapRange", cosine.outputs["Value"], low, high, 0.0, strength)
        edge.interpolation_type = "SMOOTHSTEP"
        return edge.outputs[0]

    x, y, _ = node("ShaderNodeSeparateXYZ", direction).outputs
    bars = maths("GREATER_THAN", maths("SINE", maths("MULTIPLY", x, 16.0)), 0.2)
    behind = maths("GREATER_THAN", y, 0.5)
    light = maths("MULTIPLY", maths("MULTIPLY", bars, behind), 1.1)
    for window in (
        along((-0.70, -0.45, 0.55), 0.80, 0.86, 5.0),
        along((0.93, -0.25, 0.25), 0.88, 0.92, 3.0),
        along((0.0, 0.0, 1.0), -0.2, 1.0, 0.5),
    ):
        light = maths("ADD", light, window)
    node("ShaderNodeOutputWorld", node("ShaderNodeBackground", None, light).outputs[0])


def main():
    args = gallery.start("beyond_lobes", samples=192)
    import bpy

    gallery.studio(
        args,
        SIZE,
        view=(0, -9, 1.5),
        target=(0, 0, 0),
        height=2.25,
        lights=(),
    )
    windows()
    scene = bpy.context.scene
    scene.cycles.shading_system = True
    scene.cycles.max_bounces = 6
    obj = ball()
    metal = (0.85, 0.62, 0.36, 1)
    white = (1, 1, 1, 1)
    squeezed = {"Color": metal, "Roughness": 0.5, "Tension": (1, 0, SQUEEZE)}
    # A closure that is rougher than 1 along V: alphas 0.5 and 1 instead of 0.5 and 1.43.
    cut = {"Color": metal, "Roughness": 0.5**0.25, "Anisotropy": 1 - math.sqrt(0.5)}
    cloth = {"Color": (0.75, 0.12, 0.16, 1), "Distribution": 3, "Roughness": 0.3}
    scales = {
        "Color": metal,
        "Distribution": 4,
        "Roughness": 0.3,
        "Roughness_Across": 0.12,
        "Tilt": (0.35, 0, 0),
    }
    glass = {"Color": white, "Roughness": 0.12, "Tail": 1.6, "Refraction": True, "IOR": 1.45}
    cells = []
    for caption, kind, settings in (
        ("squeezed: cut closure", "ShaderNodeBsdfAnisotropic", cut),
        ("squeezed: LTMD Glossy", "glossy", squeezed),
        ("squeezed: random normals", "reference", squeezed),
        ("squeezed: grooves", "reference", {**squeezed, "Masking": 2}),
        ("cloth (sheen)", "reference", cloth),
        ("tilted scales", "reference", scales),
        ("glass at rest", "reference", glass),
        ("glass, stretched", "reference", {**glass, "Tension": STRETCHED}),
    ):
        material(obj, caption, kind, **settings)
        gallery.say(caption)
        cells.append([caption, gallery.render(args, caption.replace(" ", "_").replace(":", ""))])
    sheet = {"title": "Beyond lobes: what random normals render", "columns": 4, "cells": cells}
    (args.out / "sheet.json").write_text(json.dumps(sheet, indent=1))
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / "beyond_lobes.blend"))
    gallery.finish()


if __name__ == "__main__":
    main()
