# SPDX-License-Identifier: Apache-2.0
"""Rubber birds and dogs, stretched, squashed, blown up and wrung: Fig. 6 in kind."""

import math

import gallery
import numpy as np
import solids

BIRD = {"Body": (0.0015, 0.013, 0.026), "Belly": (0.13, 0.030, 0.004), "Beak": (0.22, 0.08, 0.006)}
DOG = {"Body": (0.036, 0.0035, 0.0025), "Belly": (0.13, 0.065, 0.03), "Collar": (0.003, 0.04, 0.08)}
BLACK = (0.002, 0.002, 0.002)
SIZE, DETAIL, STEP = (1152, 300), 136, 0.016


def bird(p):
    """Distances to the parts by name; the figure faces +x and stands on z = 0."""
    side = np.abs(p * (0, 1, 0)) + p * (1, 0, 1)
    body = solids.ellipsoid(p, (0, 0, 0.55), (0.66, 0.47, 0.50), -0.25)
    body = solids.blend(body, solids.ellipsoid(p, (0.36, 0, 1.06), (0.36, 0.35, 0.34)), 0.30)
    tail = solids.ellipsoid(p, (-0.78, 0, 0.86), (0.46, 0.19, 0.085), 0.55)
    body = solids.blend(body, tail, 0.22)
    wing = solids.ellipsoid(side, (-0.10, 0.43, 0.66), (0.48, 0.085, 0.23), 0.35, -0.22)
    body = solids.blend(body, wing, 0.05)
    beak = solids.capsule(p, (0.66, 0, 1.07), (0.90, 0, 1.01), 0.10, 0.022)
    eye = solids.ellipsoid(side, (0.585, 0.225, 1.165), (0.055, 0.055, 0.055))
    belly = solids.ellipsoid(p, (0.34, 0, 0.52), (0.36, 0.36, 0.44), -0.35)
    return {"Body": body, "Beak": beak, "Eye": eye}, {"Belly": belly - 0.03}


def dog(p):
    side = np.abs(p * (0, 1, 0)) + p * (1, 0, 1)
    body = solids.capsule(p, (-0.16, 0, 0.44), (0.14, 0, 1.02), 0.42, 0.25)
    head = solids.ellipsoid(p, (0.25, 0, 1.44), (0.35, 0.33, 0.32))
    body = solids.blend(body, head, 0.12)
    muzzle = solids.capsule(p, (0.44, 0, 1.36), (0.64, 0, 1.33), 0.18, 0.145)
    body = solids.blend(body, muzzle, 0.08)
    leg = solids.capsule(side, (0.24, 0.17, 0.78), (0.33, 0.19, 0.10), 0.13, 0.11)
    leg = solids.blend(leg, solids.ellipsoid(side, (0.42, 0.19, 0.085), (0.17, 0.115, 0.09)), 0.08)
    haunch = solids.ellipsoid(side, (-0.08, 0.30, 0.33), (0.34, 0.19, 0.31), 0.3)
    paw = solids.ellipsoid(side, (0.22, 0.42, 0.085), (0.20, 0.11, 0.09))
    body = solids.blend(body, solids.blend(haunch, paw, 0.08), 0.07)
    body = solids.blend(body, leg, 0.08)
    tail = solids.capsule(p, (-0.50, 0, 0.20), (-0.86, 0, 0.56), 0.11, 0.06)
    body = solids.blend(body, tail, 0.10)
    ear = solids.ellipsoid(side, (0.13, 0.36, 1.36), (0.16, 0.075, 0.31), 0.15, 0.30)
    body = solids.blend(body, ear, 0.05)
    nose = solids.ellipsoid(p, (0.79, 0, 1.41), (0.07, 0.09, 0.065))
    eye = solids.ellipsoid(side, (0.535, 0.145, 1.53), (0.05, 0.05, 0.055))
    chest = solids.ellipsoid(p, (0.45, 0, 0.86), (0.28, 0.24, 0.42), -0.2)
    collar = np.abs(solids.dot(p - (0.18, 0, 1.17), np.array((0.35, 0, 1)))) - 0.05
    collar = np.maximum(collar, 0.02 - ear)
    return {"Body": body, "Nose": nose, "Eye": eye}, {"Belly": chest, "Collar": collar}


def solid(figure):
    """The whole figure, standing flat."""

    def distance(p):
        parts = list(figure(p)[0].values())
        whole = parts[0]
        for part in parts[1:]:
            whole = solids.blend(whole, part, 0.02)
        return -solids.blend(-whole, p[..., 2], 0.03)

    return distance


def paint(mesh, points, figure, colours):
    """Colours by the nearest part, patches over the body."""
    parts, patches = figure(points)
    nearest = np.argmin(list(parts.values()), axis=0)
    colour = np.array([colours.get(name, BLACK) for name in parts])[nearest]
    for name, distance in patches.items():
        soft = np.clip(0.5 - distance / 0.02, 0, 1) * (nearest == 0)
        colour += soft[:, None] * (colours[name] - colour)
    layer = mesh.attributes.new("paint", "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", np.c_[colour, np.ones(len(colour))].astype(np.float32).ravel())


def smooth(x, low, high):
    """0 below low, 1 above high, smooth between."""
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def tall(p):
    """Pulled up, slim in the middle."""
    slim = 1 - 0.36 * np.sin(np.pi * np.clip(p[:, 2] / 1.5, 0, 1))
    return np.c_[p[:, :2] * slim[:, None], p[:, 2] * 1.65]


def squashed(p):
    """Pressed down to 57 %, bulging at the sides."""
    wide = 1.15 + 0.2 * np.sin(np.pi * np.clip(p[:, 2] / 1.5, 0, 1))
    return np.c_[p[:, :2] * wide[:, None], p[:, 2] * 0.57]


def inflated(p):
    """Blown up like a balloon; head and feet stay as they are."""
    centre = np.array((-0.05, 0, 0.6))
    amount = np.exp(-(np.linalg.norm((p - centre) / (0.75, 0.75, 0.6), axis=1) ** 2))[:, None]
    blown = p + amount * (p - centre) * 1.0
    return blown - (0, 0, blown[:, 2].min())


def twisted(p):
    """Pulled up and wrung by 130 degrees between the paws and the head."""
    angle = -math.radians(130) * smooth(p[:, 2], 0.35, 1.30)
    c, s = np.cos(angle), np.sin(angle)
    x = p[:, 0] - 0.05
    z = p[:, 2] + 0.45 * (p[:, 2] - 0.3).clip(0)
    return np.c_[c * x - s * p[:, 1] + 0.05, s * x + c * p[:, 1], z]


# Kind, deformation, place, direction it faces (degrees from the right).
ROW = [
    ("Bird", None, -4.65, -50),
    ("Bird", tall, -3.10, -50),
    ("Bird", inflated, -1.25, -50),
    ("Bird", squashed, 0.75, -50),
    ("Dog", inflated, 2.45, -125),
    ("Dog", twisted, 3.75, -10),
    ("Dog", None, 4.98, -125),
]
# Details: what, left, bottom and side in pixels of the picture.
DETAILS = [
    ("pulled up", 200, 140, 110),
    ("blown up", 375, 90, 120),
    ("pressed down", 566, 36, 100),
    ("wrung", 913, 60, 80),
]


def rubber(name, alpha, tail):
    """A clear coat over the painted colours, which follows the deformation."""
    import bpy

    material, node, _ = gallery.nodes_of(bpy.data.materials.new(name))
    colour = node("ShaderNodeAttribute", attribute_name="paint").outputs["Color"]
    tension = node("live_tension")
    coat = node(
        "dielectric",
        Base=node("ShaderNodeBsdfDiffuse", colour).outputs[0],
        Roughness=alpha,
        Roughness_Is_Alpha=True,
        Tail=tail,
        Tension=tension.outputs["Tension"],
        Tangent=tension.outputs["Tangent"],
    )
    coat.name = "Coat"
    node("ShaderNodeOutputMaterial", coat.outputs[0])
    return material


def add_figures():
    """The row of figures; their materials."""
    import bpy

    kinds = {}
    for name, figure, colours, alpha, tail in (
        ("Bird", bird, BIRD, 0.25, 2.2),
        ("Dog", dog, DOG, 0.16, 1.4),
    ):
        mesh, points = solids.mesh(name, solid(figure), (-1.4, -0.8, -0.1), (1.2, 0.8, 2.0), STEP)
        paint(mesh, points, figure, colours)
        rest = mesh.attributes.new("ltmd_rest", "FLOAT_VECTOR", "POINT")
        rest.data.foreach_set("vector", points.astype(np.float32).ravel())
        mesh.materials.append(rubber(name, alpha, tail))
        kinds[name] = mesh, points
    for name, deform, x, turn in ROW:
        mesh, points = kinds[name]
        obj = gallery.link(bpy.data.objects.new(name, mesh.copy() if deform else mesh))
        obj.location.x = x
        obj.rotation_euler.z = math.radians(turn)
        if deform:
            obj.shape_key_add(name="Basis")
            key = obj.shape_key_add(name=deform.__name__)
            key.data.foreach_set("co", deform(points).astype(np.float32).ravel())
            key.value = 1
    return [mesh.materials[0] for mesh, _ in kinds.values()]


def render_detail(args, name, left, bottom, side):
    """A square of the picture (in its pixels), enlarged to DETAIL pixels."""
    import bpy

    settings = bpy.context.scene.render
    width, height = SIZE
    settings.use_border = settings.use_crop_to_border = True
    settings.border_min_x, settings.border_max_x = left / width, (left + side) / width
    settings.border_min_y, settings.border_max_y = bottom / height, (bottom + side) / height
    settings.resolution_percentage = round(100 * DETAIL / side)
    path = gallery.render(args, name)
    settings.use_border = False
    settings.resolution_percentage = 100
    return path


def main():
    args = gallery.start("figurines", samples=56)
    import bpy

    gallery.studio(
        args,
        size=SIZE,
        view=(0, -24, 4),
        target=(0.1, 0, 1.13),
        height=2.9,
        lights=[
            ((-8, -16, 13), 50000, (1.2, 1.2)),
            ((16, 4, 5), 3500, (1, 8), (0.8, 0.9, 1)),
            ((-16, 4, 5), 4500, (1, 8), (0.8, 0.9, 1)),
        ],
    )
    gallery.stage((0.012, 0.013, 0.017), sky=[(0, 0.028), (1, 0.08)])
    gallery.say("modelling the figures")
    materials = add_figures()
    rows = {}
    for name, strength in (("plain", 0), ("ltmd", 1)):
        for material in materials:
            material.node_tree.nodes["Coat"].inputs["Strength"].default_value = strength
        gallery.say(f"rendering: {name}")
        rows[name] = [gallery.render(args, name)]
        rows[name] += [render_detail(args, f"{name}{i}", *d[1:]) for i, d in enumerate(DETAILS)]
    bpy.ops.wm.save_as_mainfile(filepath=str(args.out / f"{args.name}.blend"))
    details = [
        cell for pair in zip(rows["plain"][1:], rows["ltmd"][1:], strict=True) for cell in pair
    ]
    gallery.write_sheet(
        args,
        "Rubber figures: the first and the last are at rest, the others are deformed",
        [
            {
                "cells": rows["plain"][:1],
                "captions": [
                    ("Plain material", "the same highlight, whatever happens to the rubber")
                ],
            },
            {
                "cells": details,
                "captions": [(name, what) for what, *_ in DETAILS for name in ("plain", "LTMD")],
            },
            {
                "cells": rows["ltmd"][:1],
                "captions": [
                    (
                        "With LTMD",
                        "sharper along a stretch, duller along a squeeze",
                    )
                ],
            },
        ],
        gap=8,
    )
    gallery.finish()


if __name__ == "__main__":
    main()
