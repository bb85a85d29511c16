# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Glossy: one GGX lobe that follows the deformation."""

from math import pi

from .. import osl_script
from . import add_input, add_output, ends

NAME = "LTMD Glossy"
VERSION = 1

# Group socket -> shader parameter, where they differ.
PARAMETERS = {"Height Response": "HeightResponse"}


def build(tree):
    add_output(tree, "BSDF", "Shader", "Reflection; mix it over the rest of the material")
    add_input(tree, "Color", "Color", "How much of each colour is reflected", (0.8, 0.8, 0.8, 1.0))
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
    add_input(
        tree,
        "Tension",
        "Vector",
        "How the surface is deformed: from LTMD Live Tension or LTMD Texture Tension. "
        "1, 0, 1 is the rest state",
        (1.0, 0.0, 1.0),
    )
    add_input(
        tree,
        "Tangent",
        "Vector",
        "Direction of the UV map's U on the surface, from the same node as the tension",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )
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
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_glossy")
    for socket in start.outputs:
        if socket.name:
            parameter = PARAMETERS.get(socket.name, socket.name)
            tree.links.new(socket, script.inputs[parameter])
    tree.links.new(script.outputs["BSDF"], end.inputs["BSDF"])
