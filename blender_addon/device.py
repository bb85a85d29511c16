# SPDX-License-Identifier: GPL-3.0-or-later
"""Can this scene's device render Open Shading Language, and does it?"""

import bpy

from . import drive, nodes, surface, versions
from .nodes.replace import replace


def osl_on(scene):
    """Is the scene rendered by Cycles with Open Shading Language?"""
    return scene.render.engine == "CYCLES" and scene.cycles.shading_system


def _gpu(context):
    """The kind of GPU the scene's Cycles uses, or None for the CPU."""
    if context.scene.cycles.device != "GPU":
        return None
    addon = context.preferences.addons.get("cycles")
    kind = addon.preferences.compute_device_type if addon else "NONE"
    return None if kind == "NONE" else kind


def has_osl(context):
    """Could the scene's device render Open Shading Language?"""
    return bpy.app.build_options.cycles_osl and _gpu(context) in (None, "OPTIX")


def osl_status(context):
    """(will this scene's renders use OSL, a sentence that says so or what is in the way)."""
    scene, gpu = context.scene, _gpu(context)
    if not bpy.app.build_options.cycles_osl:
        return False, "This Blender is built without Open Shading Language: stock nodes are used"
    if scene.render.engine != "CYCLES":
        return False, "The render engine is not Cycles: a plain material is shown"
    if gpu not in (None, "OPTIX"):
        return False, (
            f"{gpu} devices cannot use Open Shading Language: stock nodes are used there; live "
            "tension needs OptiX or the CPU"
        )
    if not scene.cycles.shading_system:
        return False, "Open Shading Language is off: press Set Up LTMD to use it or stock nodes"
    name = "GPU (OptiX)" if gpu else "CPU"
    return True, f"Renders on the {name} with Open Shading Language"


def uses_osl(context):
    """Do the scene's renders use OSL? Then the groups in OSL are right, otherwise their twins."""
    return has_osl(context) and osl_on(context.scene)


def mismatch(material, context):
    """What is wrong with the material's groups on this device, as a sentence, or None."""
    osl = uses_osl(context)
    if context.scene.render.engine != "CYCLES" or not _to_change(material, osl):
        return None
    if osl:
        return f"{material.name} uses stock nodes, but Open Shading Language is on: update it"
    shows = "shows the rest state" if drive.is_driven(material) else "renders black"
    return f"{material.name} {shows} here, without Open Shading Language: update it"


def match(material, osl):
    """Give the material the groups in OSL or their twins; return how many nodes have changed."""
    pairs = _to_change(material, osl)
    for node, module in pairs:
        replace(node, module)
    tree = material.node_tree
    for node in surface.our_nodes(material, "source"):
        if node.type == "TANGENT" and not node.outputs[0].is_linked:
            tree.nodes.remove(node)
        elif "Tangent" in node.inputs and not node.inputs["Tangent"].is_linked:
            _add_tangent(tree, node)
    return len(pairs)


def _add_tangent(tree, node):
    """Stock nodes take the tangent of a UV map from a node with its name."""
    tangent = surface.own(tree.nodes.new("ShaderNodeTangent"), "source", node.parent)
    tangent.direction_type = "UV_MAP"
    tangent.location = (node.location.x - 200, node.location.y - 150)
    if node.inputs["UV"].is_linked:
        tangent.uv_map = getattr(node.inputs["UV"].links[0].from_node, "uv_map", "")
    tree.links.new(tangent.outputs[0], node.inputs["Tangent"])


def _to_change(material, osl):
    """[(node, the group it should show)]"""
    known = versions.modules()
    changes = []
    for node in surface.our_nodes(material):
        ours = node.type == "GROUP" and node[surface.KEY] != surface.EEVEE
        name = node.node_tree.get(nodes.GROUP_KEY, "") if ours else ""
        plain = name.removesuffix(" (no OSL)")
        if plain in known and f"{plain} (no OSL)" in known:
            wanted = plain if osl else f"{plain} (no OSL)"
            if name != wanted:
                changes.append((node, known[wanted]))
    return changes
