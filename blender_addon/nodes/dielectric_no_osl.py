# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Dielectric (no OSL): the sum of lobes of LTMD Dielectric by stock nodes, each over what it
leaves of the base.

A GGX lobe is the reflection of a black Principled BSDF, which has Fresnel's factor on each
microfacet; a Beckmann lobe is a Metallic BSDF with the coat's reflectance straight on and at 82
degrees. Both tint only what is reflected straight on, and are at most 10 times as long as wide.
"""

from . import add_output, ends
from .coat_albedo import share
from .dielectric import add_coat_inputs
from .gtr_lobes import function
from .lobe_sum import DeformedLobes, mark_unused, metallic_node, mix, principled_anisotropy
from .material_inputs import add_material_inputs
from .node_math import Vector, arrange, inputs

NAME = "LTMD Dielectric (no OSL)"
VERSION = 1


def fresnel(cosine, ior):
    """Of a dielectric, by nodes."""
    g = (cosine * cosine + (ior * ior - 1.0)).sqrt()
    across = (g - cosine) / (g + cosine)
    along = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return across * across * (along * along + 1.0) * 0.5


def build(tree):
    add_output(tree, "BSDF", "Shader", "The base under its coat")
    add_coat_inputs(tree)
    add_material_inputs(tree)
    mark_unused(tree)
    start, end = ends(tree)
    given = inputs(tree, start)
    lobes = DeformedLobes(tree, given)
    ior = given["IOR"].at_least(1.0)
    straight = fresnel(ior * 0.0 + 1.0, ior)
    rise = fresnel(lobes.z, ior) - straight
    edge = ior * 0.0 + 1 / 7  # cosine of 82 degrees
    by_schlick = straight + (1.0 - straight) * (6 / 7) ** 5
    edge_tint = (fresnel(edge, ior) / by_schlick).at_most(1.0)
    tint = Vector(tree, start.outputs["Coat Tint"])
    colour = tint * straight
    left = share()

    def over_base(distribution, alpha):
        x, y = lobes.alphas(alpha)
        roughness = (x * y).sqrt().sqrt()
        if distribution == "GGX":
            node = tree.nodes.new("ShaderNodeBsdfPrincipled")
            node.distribution = "GGX"
            node.inputs["Base Color"].default_value = (0, 0, 0, 1)
            ior.feed(node.inputs["IOR"])
            tint.feed(node.inputs["Specular Tint"])
            roughness.feed(node.inputs["Roughness"])
            principled_anisotropy(x, y).feed(node.inputs["Anisotropic"])
            lobes.rough.feed(node.inputs["Tangent"])
            lobes.normal.feed(node.inputs["Normal"])
        else:
            node = metallic_node(lobes, distribution, alpha, "F82")
            colour.feed(node.inputs["Base Color"])
            edge_tint.feed(node.inputs["Edge Tint"])
        kept = straight + rise * function(left, roughness, lobes.z)
        both = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(node.outputs[0], both.inputs[0])
        tree.links.new(mix(tree, kept, start.outputs["Base"], None), both.inputs[1])
        return both.outputs[0]

    tree.links.new(lobes.mixed(over_base, 4), end.inputs["BSDF"])
    arrange(tree)
