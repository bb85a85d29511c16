# SPDX-License-Identifier: Apache-2.0
"""Six vases of brushed aluminium, from polished to rough, with and without glow: Fig. 8 in kind."""

import gallery
import solids

ALPHAS, TAILS = (0.01, 0.04, 0.16), (1.0, 3.5)
STRETCH = 0.6  # brushing stretches the microsurface around the vase by 1 / (1 - 0.6) = 5/2
# Radius and height: up the outside, over the lip, down the inside.
OUTSIDE = [(0.33, 0), (0.345, 0.02), (0.36, 0.06), (0.44, 0.28), (0.53, 0.66), (0.50, 0.98)]
OUTSIDE += [(0.30, 1.28), (0.175, 1.56), (0.215, 1.80), (0.315, 1.91)]
INSIDE = [(0.318, 1.925), (0.305, 1.93), (0.20, 1.80), (0.16, 1.56), (0.20, 1.40)]


def aluminium(alpha, tail):
    import bpy

    name = f"Brushed aluminium {alpha} {tail}"
    material, node, _ = gallery.nodes_of(bpy.data.materials.new(name))
    around = node("ShaderNodeTangent", direction_type="UV_MAP", uv_map="UVMap").outputs[0]
    metal = node(
        "conductor",
        Base_Color=(0.912, 0.914, 0.920, 1),
        Roughness=alpha,
        Roughness_Is_Alpha=True,
        Tail=tail,
        Stretch=STRETCH,
        Tangent=around,
    )
    node("ShaderNodeOutputMaterial", metal.outputs[0])
    return material


def main():
    args = gallery.start("vases", samples=48)
    import bpy

    gallery.studio(
        args,
        size=(300, 400),
        view=(0, -9, 2.1),
        target=(0, 0, 0.98),
        height=2.35,
        lights=[
            ((-3.2, -4.2, 2.2), 90, (0.35, 1.6), (1, 0.86, 0.70)),
            ((3.6, -2.2, 1.6), 150, (0.25, 4.0), (0.75, 0.87, 1)),
            ((-4.0, 2.6, 1.8), 160, (0.5, 4.0), (0.75, 0.87, 1)),
            ((0.5, -1.3, 3.8), 70, (0.8, 0.8)),
        ],
        perspective=True,
    )
    gallery.stage((0.09, 0.092, 0.10), sky=[(0, 0.02), (0.5, 0.07), (1, 0.5)])
    bpy.context.scene.cycles.max_bounces = 3  # the neck reflects the body
    outline = solids.smooth_curve(OUTSIDE + INSIDE, 260)
    vase = gallery.link(bpy.data.objects.new("Vase", solids.turned("Vase", outline, 192)))
    rows = []
    for tail, name, note in zip(
        TAILS,
        ("Long glow", "No glow"),
        ("tail 1, the Berry\ndistribution", "tail 3.5"),
        strict=True,
    ):
        cells = []
        for alpha in ALPHAS:
            gallery.say(f"rendering: alpha {alpha}, tail {tail}")
            vase.data.materials.clear()
            vase.data.materials.append(aluminium(alpha, tail))
            cells.append(gallery.render(args, f"alpha{alpha}_tail{tail}"))
        rows.append({"name": name, "note": note, "cells": cells})
    rows[0]["captions"] = [
        (name, f"alpha {alpha:g}")
        for name, alpha in zip(("polished", "satin", "rough"), ALPHAS, strict=True)
    ]
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / f"{args.name}.blend"))
    title = "Brushed aluminium: the same stretch, three roughnesses, two tails"
    gallery.write_sheet(args, title, rows, gap=14)
    gallery.finish()


main()
