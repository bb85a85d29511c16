# SPDX-License-Identifier: GPL-3.0-or-later
"""GTR that follows the deformation as a mixture of stock BSDF nodes: what the materials without OSL
have in common."""

from . import group_node, gtr_lobes, parameters_no_osl
from .node_math import Scalar, Vector

UNUSED = ("Lobes", "Mode", "Preserve Energy")


class DeformedLobes:
    """alpha at rest; scale_x and scale_y, by which the deformation multiplies it along `smooth` and
    `rough`; the normal."""

    def __init__(self, tree, given):
        self.tree = tree
        node = group_node(tree, parameters_no_osl)
        for socket in node.inputs:
            if not socket.name.startswith("Roughness"):
                given[socket.name].feed(socket)
        node.inputs["Roughness"].default_value = 1.0
        out = node.outputs
        self.scale_x = Scalar(tree, out["Alpha X"])
        self.scale_y = Scalar(tree, out["Alpha Y"])
        self.smooth = Vector(tree, out["Tangent"])
        self.rough = Vector(tree, out["Principled Tangent"])
        geometry = tree.nodes.new("ShaderNodeNewGeometry")
        linked = given["Normal"].dot(given["Normal"]) > 0.0
        self.normal = linked.choose(given["Normal"], Vector(tree, geometry.outputs["Normal"]))
        self.viewer = Vector(tree, geometry.outputs["Incoming"])
        self.alpha = parameters_no_osl.alpha_of(given)
        self.tail = given["Tail"]

        # Towards the viewer: v_z, and the length of v across the normal in units of the slopes.
        self.z = self.viewer.dot(self.normal.normalized()).at_least(0.0)
        along = self.viewer.dot(self.smooth) * self.scale_x
        across = self.viewer.dot(self.rough) * self.scale_y
        self.across = (along * along + across * across).sqrt()

    def alphas(self, alpha):
        """alpha_x and alpha_y of a lobe, as Cycles clamps them."""
        return (alpha * self.scale_x).at_most(1.0), (alpha * self.scale_y).at_most(1.0)

    def area(self, distribution, alpha):
        """2 v_z (1 + Lambda(v)) of a lobe, as in osl/include/ltmd_lobes.h."""
        across = alpha * self.across
        if distribution == "GGX":
            return self.z + (self.z * self.z + across * across).sqrt()
        a = (self.z / across.at_least(1e-30)).at_most(1.6)
        low = a.times_plus(0.396, -1.259).times_plus(a, 1.0) / a.times_plus(2.181, 3.535)
        return self.z * 2.0 + (a < 1.6) * across * 2.0 * low

    def mixed(self, make, most):
        """The shader of all lobes; make(distribution, alpha) gives the output of one.

        most: how many lobes the shader in OSL takes where it does not take three.
        """
        # What a factor of 0 or 1 switches off is not evaluated.
        narrow = self.alpha < 0.1
        wide = self._sum(make, 3)
        lobes = mix(self.tree, narrow, wide, self._sum(make, most))
        beyond = self._sum(make, most, beyond=True)
        lobes = mix(self.tree, self.tail > 2.0, lobes, beyond)
        single = self.tail._math("COMPARE", self.tail, 2.0, 1e-6)
        return mix(self.tree, single, lobes, make("GGX", self.alpha))

    def _sum(self, make, count, beyond=False):
        shader = total = None
        for distribution, alpha, weight in gtr_lobes.lobes(self.alpha, self.tail, count, beyond):
            # Of the area that is visible from the viewer: w_i (1 + Lambda_i) over the sum of these.
            share = weight * self.area(distribution, alpha)
            lobe = make(distribution, alpha)
            total = total + share if total else share
            shader = mix(self.tree, share / total, shader, lobe) if shader else lobe
        return shader


def mix(tree, factor, zero, one):
    node = tree.nodes.new("ShaderNodeMixShader")
    factor.feed(node.inputs[0])
    for shader, socket in ((zero, node.inputs[1]), (one, node.inputs[2])):
        if shader is not None:
            tree.links.new(shader, socket)
    return node.outputs[0]


def principled_anisotropy(x, y):
    """For Principled and Metallic BSDFs: alpha_y / alpha_x = 1 - 0.9 A."""
    return ((1.0 - x / y.at_least(1e-30)) / 0.9).at_most(1.0)


def metallic_node(lobes, distribution, alpha, kind):
    """A Metallic BSDF of one lobe, for the caller to give it its colours."""
    node = lobes.tree.nodes.new("ShaderNodeBsdfMetallic")
    node.distribution, node.fresnel_type = distribution, kind
    x, y = lobes.alphas(alpha)
    (x * y).sqrt().sqrt().feed(node.inputs["Roughness"])
    principled_anisotropy(x, y).feed(node.inputs["Anisotropy"])
    lobes.rough.feed(node.inputs["Tangent"])
    lobes.normal.feed(node.inputs["Normal"])
    return node


def mark_unused(tree):
    """Say at the inputs which the stock nodes cannot follow that they have no effect."""
    for item in tree.interface.items_tree:
        if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name in UNUSED:
            item.description = "No effect without Open Shading Language"
            item.hide_value = True
