# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Glossy: reflection without Fresnel that follows the deformation."""

from .. import osl_script
from . import add_input, add_output, ends, link_script
from .material_inputs import add_material_inputs

NAME = "LTMD Glossy"
VERSION = 2


def build(tree):
    add_output(tree, "BSDF", "Shader", "Reflection; mix it over the rest of the material")
    add_input(tree, "Color", "Color", "How much of each colour is reflected", (0.8, 0.8, 0.8, 1.0))
    add_material_inputs(tree)
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_glossy")
    link_script(tree, start, script)
    tree.links.new(script.outputs["BSDF"], end.inputs["BSDF"])
