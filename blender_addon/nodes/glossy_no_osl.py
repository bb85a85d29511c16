# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Glossy (no OSL): the sum of lobes of LTMD Glossy by stock Glossy BSDF nodes."""

from . import add_input, add_output, ends
from .lobe_sum import DeformedLobes, mark_unused
from .material_inputs import add_material_inputs
from .node_math import arrange, inputs

NAME = "LTMD Glossy (no OSL)"
VERSION = 1


def build(tree):
    add_output(tree, "BSDF", "Shader", "Reflection; mix it over the rest of the material")
    add_input(tree, "Color", "Color", "How much of each colour is reflected", (0.8, 0.8, 0.8, 1.0))
    add_material_inputs(tree)
    mark_unused(tree)
    start, end = ends(tree)
    lobes = DeformedLobes(tree, inputs(tree, start))

    def glossy(distribution, alpha):
        node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
        node.distribution = distribution
        x, y = lobes.alphas(alpha)
        tree.links.new(start.outputs["Color"], node.inputs["Color"])
        (x * y).sqrt().sqrt().feed(node.inputs["Roughness"])
        (1.0 - (x / y.at_least(1e-30)).sqrt()).feed(node.inputs["Anisotropy"])
        lobes.smooth.feed(node.inputs["Tangent"])
        lobes.normal.feed(node.inputs["Normal"])
        return node.outputs[0]

    tree.links.new(lobes.mixed(glossy, 5), end.inputs["BSDF"])
    arrange(tree)
