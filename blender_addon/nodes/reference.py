# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Reference: exact distributions by random normals, also those that no closure renders."""

from math import pi

from .. import osl_script
from . import add_input, add_output, ends, link_script
from .material_inputs import add_roughness_inputs, add_surface_inputs

NAME = "LTMD Reference"
VERSION = 1


def build(tree):
    add_output(
        tree,
        "BSDF",
        "Shader",
        "Exact and noisy. It is lit by the world, other surfaces and lamps with a size; point "
        "lamps and suns without an angle leave it dark",
    )
    add_input(
        tree, "Color", "Color", "How much of each colour is reflected, or the tint of glass",
        (0.8, 0.8, 0.8, 1.0),
    )  # fmt: skip
    add_input(
        tree,
        "Distribution",
        "Int",
        "The microscopic bumps. 0: any tail (GTR); 1: rolling hills without a tail (Beckmann); "
        "2: another family of tails (STD); 3: cloth (sheen); 4: half ellipsoids, also tilted "
        "like scales or brushed hair",
        0,
        0,
        4,
    )
    add_input(
        tree,
        "Masking",
        "Int",
        "How bumps hide each other at grazing angles. 0: like hills, seen and lit alike (Smith, "
        "height-correlated); 1: a little darker (separable); 2: like grooves (V-cavity)",
        0,
        0,
        2,
    )
    add_roughness_inputs(tree)
    add_input(
        tree,
        "Tail",
        "Float",
        "How far the highlight's glow reaches, of distribution 0 (0 to 4) and 2 (from 1.6). 2: as "
        "stock Glossy (GGX); lower: a wider halo around a sharper core",
        2.0,
        0.0,
        100.0,
    )
    add_input(
        tree,
        "Roughness Across",
        "Float",
        "Roughness of ellipsoids along the UV map's V; along U it is Roughness",
        0.5,
        0.0,
        1.0,
        subtype="FACTOR",
    )
    add_input(
        tree,
        "Tilt",
        "Vector",
        "Turns the ellipsoids about U, V and the normal: the highlight leaves the mirror direction",
        (0.0, 0.0, 0.0),
        -pi,
        pi,
        subtype="EULER",
    )
    add_surface_inputs(tree)
    add_input(tree, "Refraction", "Bool", "Glass instead of a mirror", False)
    add_input(tree, "IOR", "Float", "How strongly glass bends light", 1.5, 1.0, 4.0)
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_reference")
    link_script(tree, start, script)
    tree.links.new(script.outputs["BSDF"], end.inputs["BSDF"])
