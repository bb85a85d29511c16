# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs that every LTMD material has."""

from math import pi

from . import add_input, add_tension_inputs


def add_material_inputs(tree):
    """Add them all, in the order of the interface."""
    add_roughness_inputs(tree)
    add_input(
        tree,
        "Tail",
        "Float",
        "How far the highlight's glow reaches. 2: as stock Glossy (GGX); lower: a wider halo "
        "around a sharper core; higher: less halo, 4 has nearly none",
        2.0,
        0.0,
        4.0,
    )
    add_surface_inputs(tree)
    add_input(
        tree,
        "Lobes",
        "Int",
        "How many highlights are added up to shape the tail: more are more exact and slower. "
        "0 chooses: one for Tail 2, otherwise 3 to 5",
        0,
        0,
        6,
    )
    add_input(
        tree,
        "Mode",
        "Int",
        "0 adds up the highlights. 1 takes one of them at random: the same picture with more "
        "noise, for materials with too many closures. 2 is exact and very noisy, for comparisons",
        0,
        0,
        2,
    )
    add_input(
        tree,
        "Preserve Energy",
        "Float",
        "Brightens rough reflections by the light that bounces between the bumps: 0 leaves it "
        "out, 1 adds all of it",
        0.0,
        0.0,
        1.0,
        subtype="FACTOR",
    )


def add_roughness_inputs(tree):
    add_input(
        tree,
        "Roughness",
        "Float",
        "Size of the highlight at rest: 0 is a mirror, 1 is dull",
        0.5,
        0.0,
        1.0,
        subtype="FACTOR",
    )
    add_input(
        tree,
        "Roughness Is Alpha",
        "Bool",
        "Take Roughness for the slope of the microscopic bumps as it is (alpha, as in papers) "
        "instead of its square (as in other nodes)",
        False,
    )


def add_surface_inputs(tree):
    """Anisotropy and deformation."""
    add_input(
        tree,
        "Stretch",
        "Float",
        "Anisotropy of the material at rest. Positive: smoother along the UV map's U, so the "
        "highlight is drawn out across it; negative: the other way; 0: round highlights",
        0.0,
        -0.99,
        0.99,
        subtype="FACTOR",
    )
    add_input(
        tree,
        "Rotation",
        "Float",
        "Turns the anisotropy on the surface, counter-clockwise from U; brushed metal follows it",
        0.0,
        -2 * pi,
        2 * pi,
        subtype="ANGLE",
    )
    add_input(
        tree,
        "Shear",
        "Float",
        "Slants the anisotropy along U; 0: none, 1: by 45 degrees",
        0.0,
        -10.0,
        10.0,
    )
    add_tension_inputs(tree)
    add_input(
        tree,
        "Normal",
        "Vector",
        "From a Bump or Normal Map node; not linked: the surface's own",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )
    add_input(
        tree,
        "Strength",
        "Float",
        "How much of the deformation the highlight follows: 0 ignores it, 1 is exact, more "
        "exaggerates",
        1.0,
        0.0,
        4.0,
    )
    add_input(
        tree,
        "Height Response",
        "Float",
        "What a change of area does to the microscopic bumps. 0: they keep their height; "
        "1: they keep their volume, so stretching both ways gives a still smoother surface",
        0.0,
        -1.0,
        2.0,
    )
