# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Conductor (no OSL): the sum of lobes of LTMD Conductor by stock Metallic BSDF nodes, whose
highlights are at most 10 times as long as wide."""

from . import add_output, ends
from .conductor import add_metal_inputs
from .lobe_sum import DeformedLobes, mark_unused, metallic_node, mix
from .material_inputs import add_material_inputs
from .node_math import arrange, inputs

NAME = "LTMD Conductor (no OSL)"
VERSION = 1

# Kind of Fresnel -> the inputs it takes, as Conductor Type counts them.
KINDS = {"F82": ("Base Color", "Edge Tint"), "PHYSICAL_CONDUCTOR": ("IOR", "Extinction")}


def build(tree):
    add_output(tree, "BSDF", "Shader", "The metal's reflection")
    add_metal_inputs(tree)
    add_material_inputs(tree)
    mark_unused(tree)
    start, end = ends(tree)
    given = inputs(tree, start)
    lobes = DeformedLobes(tree, given)

    def metal(distribution, alpha):
        made = []
        for kind, names in KINDS.items():
            node = metallic_node(lobes, distribution, alpha, kind)
            for name in names:
                tree.links.new(start.outputs[name], node.inputs[name])
            made.append(node.outputs[0])
        return mix(tree, given["Conductor Type"], *made)

    tree.links.new(lobes.mixed(metal, 4), end.inputs["BSDF"])
    arrange(tree)
