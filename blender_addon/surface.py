# SPDX-License-Identifier: GPL-3.0-or-later
"""The LTMD part of a material: its own nodes and output for Cycles beside the user's tree.

The user's nodes stay as they are and feed the EEVEE output. Of them only the outputs' target and
active flag change; both are recorded in Material.ltmd.record and restored by remove(). The other
way, nodes of ours that drive the user's, is in drive.py.
"""

import json
from math import pi, sqrt

from . import nodes
from .nodes import conductor, dielectric, glossy, glossy_no_osl, parameters
from .nodes.replace import replace

VERSION = 1
METHOD = "REPLACE"
KEY = "ltmd"  # custom property of every node that is ours: "surface", "source", "view" or EEVEE
EEVEE = "eevee"  # what only EEVEE shows: of stock nodes on every device
TAKEN = "ltmd_taken"  # of a node: [[its input, identifier of the driven node's socket]]

# The groups a set-up material may reflect by, and their socket for the colour of the reflection.
LOBES = {glossy.NAME: "Color", conductor.NAME: "Base Color", dielectric.NAME: "Coat Tint"}

PARAMETERS = parameters.NAME

NOT_CARRIED = (
    "Subsurface Weight",
    "Transmission Weight",
    "Coat Weight",
    "Sheen Weight",
    "Thin Film Thickness",
)


def is_set_up(material):
    return material is not None and material.ltmd.set_up > 0


def lobe(material):
    """The node that reflects, of one of LOBES, or the one that drives the user's; or None."""
    for node in material.node_tree.nodes if material.node_tree else ():
        if KEY in node and node.type == "GROUP" and lobe_kind(node) in (*LOBES, PARAMETERS):
            return node
    return None


def takers(material):
    """All nodes of ours that take a tension and its tangent."""
    return [
        node
        for node in our_nodes(material)
        if node[KEY] != EEVEE and "Tension" in node.inputs and "Tangent" in node.inputs
    ]


def lobe_kind(node):
    """Name of the node's group; its twin without OSL counts as the same."""
    name = node.node_tree.get(nodes.GROUP_KEY, "") if node.node_tree else ""
    return name.removesuffix(" (no OSL)")


def roughest(node):
    """Where the highlight reaches the roughness at which Cycles ends, as a sentence, or None."""
    inputs = node.inputs
    names = ("Roughness", "Roughness Is Alpha", "Stretch", "Shear", "Strength", "Height Response")
    if any(name not in inputs or inputs[name].is_linked for name in names):
        return None
    rough, exact, stretch, shear, strength, response = (inputs[n].default_value for n in names)
    # alpha over the smaller singular value of [[1, shear], [0, 1]] M_s, whose determinant is 1.
    sx = 1 + stretch if stretch < 0 else 1 / (1 - stretch)
    half = (sx * sx + (1 + shear * shear) / (sx * sx)) / 2
    widest = (rough if exact else rough * rough) * sqrt(half + sqrt(max(half * half - 1, 0)))
    if widest >= 1:
        return (
            "Already at rest the highlight is wider in one direction than Cycles can show: lower "
            "Roughness or Stretch"
        )
    # A squeeze to the part q of the length multiplies alpha by q^(-strength (1 + response)).
    power = strength * (1 + response)
    squeeze = widest ** (1 / power) if power > 0 else 0
    if squeeze < 1 / 3:
        return None
    light = "too bright" if nodes.without_osl(node.node_tree) else "dimmer"
    halo = "; the halo's earlier" if "Tail" in inputs and inputs["Tail"].default_value < 2 else ""
    return (
        f"Where the surface is squeezed below {squeeze:.0%} of its length, the highlight gets "
        f"{light} but no wider: the roughness of Cycles ends there{halo}"
    )


def use_lobe(material, module):
    """Let the set-up material reflect by another group; what has the same name is kept.

    Glossy is mixed with the base by Fresnel's law, a conductor has no base, a dielectric holds it.
    Raises RuntimeError if the group cannot be made here.
    """
    node, tree = lobe(material), material.node_tree
    colour = LOBES[module.NAME.removesuffix(" (no OSL)")]
    replace(node, module, {LOBES[lobe_kind(node)]: colour})
    mine = our_nodes(material, "surface")
    base = next((n for n in mine if n.type == "BSDF_DIFFUSE"), None)
    if "Base" in node.inputs and not node.inputs["Base"].is_linked and base:
        tree.links.new(base.outputs[0], node.inputs["Base"])
    for wire in list(node.outputs[0].links):
        mix = wire.to_node
        if mix.type != "MIX_SHADER" or mix.get(KEY) != "surface":
            continue
        for factor in list(mix.inputs[0].links):
            tree.links.remove(factor)
        mix.inputs[0].default_value = 1.0
        weights = [n for n in mine if n.type == "MATH"] or [n for n in mine if n.type == "FRESNEL"]
        if colour == "Color" and weights:
            tree.links.new(weights[0].outputs[0], mix.inputs[0])


def our_nodes(material, part=None):
    tree = material.node_tree
    return [n for n in tree.nodes if KEY in n and (part is None or n[KEY] == part)]


def own(node, part, parent=None):
    """Mark a node as ours."""
    node[KEY] = part
    node.parent = parent
    return node


def frame(material):
    """The frame around our nodes, or None if the user has taken it away."""
    return next((n for n in our_nodes(material, "surface") if n.type == "FRAME"), None)


def add(material, osl=True):
    """Give the material its LTMD surface for Cycles; return sentences for the user."""
    record = {"method": METHOD}
    if not material.node_tree or not material.use_nodes:
        record["use_nodes"] = False
        material.use_nodes = True
    tree = material.node_tree
    told = []

    old_output = tree.get_output_node("CYCLES") or tree.get_output_node("EEVEE")
    outputs = [n for n in tree.nodes if n.type == "OUTPUT_MATERIAL"]
    record["outputs"] = [[n.name, n.target, n.is_active_output] for n in outputs]
    active = tree.nodes.active
    record["active"] = active.name if active else ""
    principled = _principled(old_output)
    if principled is None:
        told.append(
            f"{material.name}: no Principled BSDF found, so the LTMD surface takes the viewport "
            "colour; set its colour in the LTMD nodes"
        )

    bottom = min((n.location.y - 600 for n in tree.nodes if n.parent is None), default=0)
    left = old_output.location.x - 900 if old_output else 0
    box = own(tree.nodes.new("NodeFrame"), "surface")
    box.label = "LTMD (Cycles)"

    def new(kind, x, y):
        node = own(tree.nodes.new(kind), "surface", box)
        node.location = (left + x, bottom + y)
        return node

    output = new("ShaderNodeOutputMaterial", 900, 0)
    output.name = output.label = "LTMD Output"
    reflection = own(nodes.group_node(tree, glossy if osl else glossy_no_osl), "surface", box)
    reflection.location = (left + 200, bottom - 250)
    diffuse = new("ShaderNodeBsdfDiffuse", 200, 0)
    fresnel = new("ShaderNodeFresnel", 200, 150)
    mix = new("ShaderNodeMixShader", 600, 0)

    link = tree.links.new
    link(fresnel.outputs[0], mix.inputs[0])
    link(diffuse.outputs[0], mix.inputs[1])
    link(reflection.outputs[0], mix.inputs[2])
    surface = mix.outputs[0]

    reflection.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    if principled is None:
        diffuse.inputs["Color"].default_value = material.diffuse_color
        reflection.inputs["Roughness"].default_value = material.roughness
    else:
        surface = _carry_over(principled, tree, new, diffuse, reflection, fresnel, mix, surface)
        told += [
            f"{material.name}: {name.replace(' Weight', '').lower()} is left out in Cycles"
            for name in NOT_CARRIED
            if _in_use(principled, name)
        ]

    link(surface, output.inputs["Surface"])
    for name in ("Volume", "Displacement"):
        if old_output and old_output.inputs[name].is_linked:
            link(old_output.inputs[name].links[0].from_socket, output.inputs[name])
    for node in outputs:
        if node.target == "ALL":
            node.target = "EEVEE"
    output.target = "CYCLES"
    output.is_active_output = True
    # Making one output active may switch off others: EEVEE still needs one of its own.
    if old_output and old_output.target == "EEVEE":
        old_output.is_active_output = True

    material.ltmd.record = json.dumps(record)
    material.ltmd.set_up = VERSION
    return told


def remove(material):
    """Take away exactly what add(), drive.drive() and the sources made."""
    tree = material.node_tree
    record = json.loads(material.ltmd.record or "{}")
    for node in our_nodes(material):
        _give_back(node)
    for node in our_nodes(material):
        tree.nodes.remove(node)
    if record.get("animated") is False:
        tree.animation_data_clear()
    kept = [entry for entry in record.get("outputs", ()) if entry[0] in tree.nodes]
    for name, target, _active in kept:
        tree.nodes[name].target = target
    for name, _target, active in sorted(kept, key=lambda entry: entry[2]):
        tree.nodes[name].is_active_output = active
    tree.nodes.active = tree.nodes.get(record.get("active", ""))
    if record.get("use_nodes") is False:
        material.use_nodes = False
    material.ltmd.record = ""
    material.ltmd.set_up = 0


def _give_back(node):
    """Link to the driven node again what our node has taken from it."""
    tree = node.id_data
    driven = [w.to_node for s in node.outputs for w in s.links if KEY not in w.to_node]
    for mine, theirs in json.loads(node.get(TAKEN, "[]")):
        socket = next((s for n in driven for s in n.inputs if s.identifier == theirs), None)
        if socket is not None and node.inputs[mine].is_linked:
            wire = node.inputs[mine].links[0]
            tree.links.new(wire.from_socket, socket).is_muted = wire.is_muted


def exchange(material, add_other):
    """Another method for a set-up material, which keeps its tension; return sentences.

    add_other() must take the material: with what it refuses, only the source is left.
    """
    tree = material.node_tree
    old = lobe(material)
    feeding = {
        name: old.inputs[name].links[0].from_socket
        for name in ("Tension", "Tangent")
        if old is not None and old.inputs[name].is_linked
    }
    sources = our_nodes(material, "source")
    for node in sources:
        del node[KEY]
    remove(material)
    told = add_other(material)
    for node in sources:
        own(node, "source", frame(material))
    for name, socket in feeding.items():
        for node in takers(material):
            tree.links.new(socket, node.inputs[name])
    return told


def _principled(output):
    """The Principled BSDF that feeds the output, also through mixed shaders."""
    if output is None:
        return None
    waiting = [output.inputs["Surface"]]
    seen = set()
    while waiting:
        for wire in waiting.pop(0).links:
            node = wire.from_node
            if node.type == "BSDF_PRINCIPLED":
                return node
            if node.name not in seen:
                seen.add(node.name)
                waiting += [s for s in node.inputs if s.type == "SHADER" or node.type == "REROUTE"]
    return None


def _in_use(node, name):
    socket = node.inputs.get(name)
    return socket is not None and (socket.is_linked or socket.default_value > 0)


def _carry_over(principled, tree, new, diffuse, reflection, fresnel, mix, surface):
    """Wire the Principled's values into our nodes; return the socket of the whole surface."""
    link = tree.links.new
    inputs = principled.inputs

    def follow(name, target):
        if inputs[name].is_linked:
            link(inputs[name].links[0].from_socket, target)
        else:
            target.default_value = inputs[name].default_value

    follow("Base Color", diffuse.inputs["Color"])
    follow("Roughness", reflection.inputs["Roughness"])
    if inputs["Normal"].is_linked:
        for node in (diffuse, reflection, fresnel):
            link(inputs["Normal"].links[0].from_socket, node.inputs["Normal"])

    level = inputs["Specular IOR Level"]
    if inputs["IOR"].is_linked or level.is_linked:
        follow("IOR", fresnel.inputs["IOR"])
    else:
        # The level scales the reflection at normal incidence: put it into the IOR.
        ior = inputs["IOR"].default_value
        straight = min(((ior - 1) / (ior + 1)) ** 2 * 2 * level.default_value, 0.99)
        fresnel.inputs["IOR"].default_value = (1 + sqrt(straight)) / (1 - sqrt(straight))

    amount = inputs["Anisotropic"]
    if not amount.is_linked and amount.default_value > 0:
        # Principled is rough along its tangent: alpha_x = r^2 / aspect, aspect^2 = 1 - 0.9 A.
        reflection.inputs["Stretch"].default_value = sqrt(1 - 0.9 * amount.default_value) - 1
        turn = inputs["Anisotropic Rotation"]
        if not turn.is_linked:
            reflection.inputs["Rotation"].default_value = turn.default_value * 2 * pi

    if _in_use(principled, "Metallic"):
        tint = new("ShaderNodeMix", 0, -250)
        tint.data_type = "RGBA"
        # The Mix node has one socket of each name per data type: go by identifier.
        sockets = {s.identifier: s for s in (*tint.inputs, *tint.outputs)}
        sockets["A_Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        follow("Metallic", sockets["Factor_Float"])
        follow("Base Color", sockets["B_Color"])
        link(sockets["Result_Color"], reflection.inputs["Color"])
        most = new("ShaderNodeMath", 420, 150)
        most.operation = "MAXIMUM"
        follow("Metallic", most.inputs[0])
        link(fresnel.outputs[0], most.inputs[1])
        link(most.outputs[0], mix.inputs[0])

    if _in_use(principled, "Emission Strength"):
        glow = new("ShaderNodeEmission", 600, -180)
        follow("Emission Color", glow.inputs["Color"])
        follow("Emission Strength", glow.inputs["Strength"])
        both = new("ShaderNodeAddShader", 700, 0)
        link(surface, both.inputs[0])
        link(glow.outputs[0], both.inputs[1])
        surface = both.outputs[0]

    alpha = inputs["Alpha"]
    if alpha.is_linked or alpha.default_value < 1:
        clear = new("ShaderNodeBsdfTransparent", 600, 180)
        cut = new("ShaderNodeMixShader", 750, 100)
        follow("Alpha", cut.inputs[0])
        link(clear.outputs[0], cut.inputs[1])
        link(surface, cut.inputs[2])
        surface = cut.outputs[0]
    return surface
