# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Dielectric: a clear coat that follows the deformation, over any base."""

from .. import osl_script
from . import add_input, add_output, ends, link_script
from .material_inputs import add_material_inputs

NAME = "LTMD Dielectric"
VERSION = 1


def add_coat_inputs(tree):
    """The base and the coat's reflectance."""
    add_input(
        tree,
        "Base",
        "Shader",
        "What is seen through the coat, for example a Diffuse or Subsurface Scattering node",
    )
    add_input(
        tree,
        "Coat Tint",
        "Color",
        "Tint of the highlight; white for plastic, rubber or varnish as they are",
        (1.0, 1.0, 1.0, 1.0),
    )
    add_input(
        tree,
        "IOR",
        "Float",
        "How strongly the coat reflects: 1.33 is water, 1.5 plastic or rubber; 1 no reflection",
        1.5,
        1.0,
        4.0,
    )


def build(tree):
    add_output(tree, "BSDF", "Shader", "The base under its coat")
    add_coat_inputs(tree)
    add_material_inputs(tree)
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_dielectric")
    link_script(tree, start, script)
    tree.links.new(script.outputs["BSDF"], end.inputs["BSDF"])
