# SPDX-License-Identifier: Apache-2.0
"""A torus knot with a long tail, and what stock nodes make of it: Fig. 10 (left) in kind."""

import gallery
import numpy as np

TAIL, STRETCH = 1.0, 0.75
GOLD = (0.95, 0.72, 0.38, 1)
# The Roughness of a sharp and of a dull stock node and the dull one's share that, in steps of 0.05,
# come nearest to the tail at the first alpha. At the second they are scaled with the slider.
ALPHAS, SHARP, DULL, SHARE = (0.3, 0.04), 0.60, 0.85, 0.60
ALONG, AROUND = 720, 96


def knot_mesh():
    """A tube of radius 0.42 along a knot; u runs once along it, v around it."""
    import bpy

    def centre(s):
        radius = 1.6 + 0.7 * np.cos(3 * s)
        return np.stack([radius * np.cos(2 * s), radius * np.sin(2 * s), 0.9 * np.sin(3 * s)], -1)

    s = np.arange(ALONG) / ALONG * 2 * np.pi
    t = np.arange(AROUND) / AROUND * 2 * np.pi
    along = centre(s + 1e-4) - centre(s - 1e-4)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    side = np.cross(along, (0, 0, 1))
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(side, along)
    normal = np.cos(t)[:, None] * side[:, None] + np.sin(t)[:, None] * up[:, None]
    positions = (centre(s)[:, None] + 0.42 * normal).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(ALONG), np.arange(AROUND), indexing="ij")
    steps = [(0, 0), (1, 0), (1, 1), (0, 1)]
    faces = np.stack([(i + a) % ALONG * AROUND + (j + b) % AROUND for a, b in steps], -1)
    uv = np.stack([np.stack([(i + a) / ALONG, (j + b) / AROUND], -1) for a, b in steps], -2)
    mesh = bpy.data.meshes.new("Knot")
    mesh.from_pydata(positions.tolist(), [], faces.reshape(-1, 4).tolist())
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv.astype(np.float32).ravel())
    mesh.shade_smooth()
    return mesh


def reflections(node, alpha):
    """Shader sockets of the three columns."""
    along = node("ShaderNodeTangent", direction_type="UV_MAP", uv_map="UVMap").outputs[0]

    def stock(roughness):
        lobe = node("ShaderNodeBsdfAnisotropic", GOLD, roughness, STRETCH, 0.0)
        lobe.id_data.links.new(along, lobe.inputs["Tangent"])
        return lobe.outputs[0]

    slider = (alpha / ALPHAS[0]) ** 0.5
    return {
        "lobes": node(
            "glossy",
            Color=GOLD,
            Roughness=alpha,
            Roughness_Is_Alpha=True,
            Tail=TAIL,
            Stretch=STRETCH,
            Tangent=along,
        ).outputs[0],
        "by hand": node(
            "ShaderNodeMixShader", SHARE, stock(SHARP * slider), stock(DULL * slider)
        ).outputs[0],
        "one lobe": stock(alpha**0.5),
    }


def main():
    args = gallery.start("knot", samples=32)
    import bpy

    gallery.studio(
        args,
        size=(320, 300),
        view=(0, -3.2, 11.6),
        target=(0.05, -0.08, 0),
        height=5.6,
        lights=[((-0.4, 4.2, 5.2), 700, (2.4, 1.0))],
        perspective=True,
    )
    gallery.stage((0.03, 0.03, 0.035), sky=[(0, 0.02), (1, 0.32)], depth=30)
    bpy.context.scene.cycles.max_bounces = 0
    bpy.data.objects["Stage"].location.z = -1.6
    knot = gallery.link(bpy.data.objects.new("Knot", knot_mesh()))
    rows = []
    for alpha in ALPHAS:
        material, node, _ = gallery.nodes_of(bpy.data.materials.new(f"Gold {alpha}"))
        knot.data.materials.clear()
        knot.data.materials.append(material)
        output = node("ShaderNodeOutputMaterial")
        cells = []
        for name, shader in reflections(node, alpha).items():
            gallery.say(f"rendering: alpha {alpha}, {name}")
            material.node_tree.links.new(shader, output.inputs["Surface"])
            cells.append(gallery.render(args, f"alpha{alpha}_{name.replace(' ', '_')}"))
        rows.append({"name": f"Alpha {alpha:g}", "cells": cells})
    rows[0]["note"] = "the paper's knot;\nthe mix fits this tail,\nbut shines too much"
    rows[1]["note"] = "the roughness is\nturned down"
    rows[0]["captions"] = [
        ("LTMD Glossy, tail 1", "one node"),
        ("Two stock Glossy nodes", "mixed by hand to look like it"),
        ("One stock Glossy node", "the same alpha, no tail"),
    ]
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / f"{args.name}.blend"))
    title = "A long tail on a knot under a rectangular light"
    gallery.write_sheet(args, title, rows, gap=8)
    gallery.finish()


if __name__ == "__main__":
    main()
