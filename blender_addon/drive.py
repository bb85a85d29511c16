# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Parameters in front of a material's own BSDF nodes: the material stays as it is, and its
roughness, anisotropy and tangent follow the deformation.

What was linked or typed at a driven socket becomes an input of our node; surface.give_back() brings
it back. Where the parameters' shader does not run, as in EEVEE, they give the roughness at rest.
"""

import json

from . import nodes, source, surface
from .nodes import base_anisotropy, parameters, parameters_no_osl
from .nodes.replace import curves

METHOD = "DRIVE"

# Type of node -> its sockets of anisotropy, and the outputs of LTMD Parameters in its convention.
PRINCIPLED = ("Anisotropic", "Principled Tangent")
DRIVEN = {
    "BSDF_PRINCIPLED": ("Anisotropic", "Anisotropic Rotation", *PRINCIPLED),
    "BSDF_METALLIC": ("Anisotropy", "Rotation", *PRINCIPLED),
    "BSDF_GLOSSY": ("Anisotropy", "Rotation", "Anisotropy", "Tangent"),
}


def drive(material, osl=True):
    """Drive the material's BSDF nodes; return sentences for the user. Raises SourceError."""
    module = parameters if osl else parameters_no_osl
    record = {"method": METHOD}
    if not material.node_tree or not material.use_nodes:
        record["use_nodes"] = False
        material.use_nodes = True
    tree = material.node_tree
    driven, hidden = _reflecting(tree)
    told = [
        f"{material.name}: {name} is inside a node group and stays as it is; ungroup it and "
        "convert again, or replace the material"
        for name in hidden
    ]
    if not driven:
        if "use_nodes" in record:
            material.use_nodes = False
        raise source.SourceError(
            told[0]
            if told
            else f"{material.name}: no Principled, Glossy or Metallic BSDF reaches its output; "
            "replace the material instead"
        )
    record["active"] = tree.nodes.active.name if tree.nodes.active else ""
    record["animated"] = tree.animation_data is not None
    box = surface.own(tree.nodes.new("NodeFrame"), "surface")
    box.label = "LTMD"
    for node in driven:
        _drive(material, node, module, "Roughness", "Normal")
        if node.type == "BSDF_PRINCIPLED" and _in_use(tree, node.inputs["Coat Weight"]):
            _drive(material, node, module, "Coat Roughness", "Coat Normal")
    tree.nodes.active = tree.nodes.get(record["active"])
    material.ltmd.record = json.dumps(record)
    material.ltmd.set_up = surface.VERSION
    return told


def is_driven(material):
    return surface.is_set_up(material) and json.loads(material.ltmd.record).get("method") == METHOD


def limits(material):
    """What driven nodes cannot show, as a sentence, or None."""
    if any(
        wire.to_node.type in DRIVEN and DRIVEN[wire.to_node.type][2:] == PRINCIPLED
        for node in surface.our_nodes(material, "surface")
        for socket in node.outputs
        for wire in socket.links
    ):
        return (
            f"{material.name}: highlights drawn out more than 10 : 1 are shown at 10 : 1; replaced "
            "by an LTMD group they have no limit"
        )
    return None


def _reflecting(tree):
    """(nodes to drive, names of those inside groups) that reach an output, in no certain order."""
    driven, hidden, seen = [], [], set()
    outputs = {tree.get_output_node(kind) for kind in ("CYCLES", "EEVEE")} - {None}
    waiting = [output.inputs["Surface"] for output in outputs]
    while waiting:
        for wire in waiting.pop().links:
            node = wire.from_node
            if node.name in seen:
                continue
            seen.add(node.name)
            if node.type in DRIVEN:
                driven.append(node)
            elif node.type == "GROUP" and node.node_tree:
                hidden += _inside(node.node_tree)
            waiting += [s for s in node.inputs if s.type == "SHADER" or node.type == "REROUTE"]
    return driven, hidden


def _inside(tree):
    found = []
    for node in tree.nodes:
        if node.type in DRIVEN:
            found.append(f"the {node.name} of {tree.name}")
        elif node.type == "GROUP" and node.node_tree:
            found += _inside(node.node_tree)
    return found


def _drive(material, node, module, roughness, normal):
    """Parameters for one roughness socket of the node; for the base's also its anisotropy."""
    tree = material.node_tree
    inputs = node.inputs
    ours = _new(tree, node, module, inputs[roughness].name)
    if inputs[normal].is_linked:
        _copy_link(tree, inputs[normal], ours.inputs["Normal"])
    _take(material, inputs[roughness], ours.inputs["Roughness"])
    tree.links.new(ours.outputs["Roughness"], inputs[roughness])
    if roughness != "Roughness":
        return
    amount, turn, amount_output, tangent_output = DRIVEN[node.type]
    own_frame = inputs["Tangent"].is_linked
    if own_frame or _in_use(tree, inputs[amount]) or _in_use(tree, inputs[turn]):
        base = _new(tree, node, base_anisotropy, "", 250)
        if inputs[normal].is_linked:
            _copy_link(tree, inputs[normal], base.inputs["Normal"])
        if node.type == "BSDF_GLOSSY":
            _take(material, inputs[amount], ours.inputs["Stretch"])
        else:
            _take(material, inputs[amount], base.inputs["Anisotropic"])
            tree.links.new(base.outputs["Stretch"], ours.inputs["Stretch"])
        _take(material, inputs[turn], base.inputs["Base Rotation"])
        if own_frame:
            _take(material, inputs["Tangent"], base.inputs["Base Tangent"])
        tree.links.new(base.outputs["Rotation"], ours.inputs["Rotation"])
        tree.links.new(base.outputs["No Rotation"], inputs[turn])
    tree.links.new(ours.outputs[amount_output], inputs[amount])
    tree.links.new(ours.outputs[tangent_output], inputs["Tangent"])


def _new(tree, beside, module, label, away=0):
    node = surface.own(nodes.group_node(tree, module), "surface", beside.parent)
    if label == "Coat Roughness":
        node.label = f"{module.NAME}: Coat"
    node.location = (beside.location.x - 250 - away, beside.location.y - 60 - 500 * bool(away))
    return node


def _take(material, theirs, mine):
    """Let our input have what their socket has; its link moves, its value stays for later."""
    tree = material.node_tree
    mine.default_value = theirs.default_value  # a muted link leaves it in use
    if _is_animated(tree, theirs):
        _follow(material, theirs, mine)
    if theirs.is_linked:
        _copy_link(tree, theirs, mine)
    node = mine.node
    taken = json.loads(node.get(surface.TAKEN, "[]"))
    node[surface.TAKEN] = json.dumps([*taken, [mine.name, theirs.identifier]])


def _copy_link(tree, theirs, mine):
    wire = theirs.links[0]
    tree.links.new(wire.from_socket, mine).is_muted = wire.is_muted


def _in_use(tree, socket):
    return socket.is_linked or socket.default_value != 0 or _is_animated(tree, socket)


def _is_animated(tree, socket):
    data = tree.animation_data
    path = socket.path_from_id("default_value")
    return data is not None and any(curve.data_path == path for curve in curves(data))


def _follow(material, theirs, mine):
    """A driver without expression: the animated value is still that of their socket."""
    driver = mine.driver_add("default_value").driver
    driver.type = "AVERAGE"
    target = driver.variables.new().targets[0]
    target.id_type = "MATERIAL"
    target.id = material
    target.data_path = f"node_tree.{theirs.path_from_id('default_value')}"
