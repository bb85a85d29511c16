# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator Apply Preset."""

import bpy
from bpy.props import EnumProperty

from . import nodes, presets, setup, source, surface, versions
from .writable import NODES_REFUSAL, is_local


def apply(material, preset):
    """Give a set-up material the preset's group and values; return sentences for the user.

    What the user's own nodes feed stays so. Raises SourceError, or RuntimeError if the group cannot
    be made here.
    """
    node = surface.lobe(material)
    if node is None or surface.lobe_kind(node) not in surface.LOBES:
        raise source.SourceError(
            f"{material.name} has no LTMD highlight for a preset to set: convert it by replacing"
        )
    module = preset.group
    if nodes.without_osl(node.node_tree):
        module = versions.modules()[f"{module.NAME} (no OSL)"]
    surface.use_lobe(material, module)
    kept = []
    for name, value in preset.sockets.items():
        if not _set(material, node.inputs[name], value):
            kept.append(name)
    if preset.base:
        base = [n for n in surface.our_nodes(material, "surface") if n.type == "BSDF_DIFFUSE"]
        kept += ["Base Color" for n in base if not _set(material, n.inputs["Color"], preset.base)]
    if not kept:
        return []
    return [f"{material.name}: {', '.join(kept)} as the nodes linked to it say, not as the preset"]


def _set(material, socket, value):
    """Set an input of ours; False if the user's own nodes feed it."""
    for wire in list(socket.links):
        if surface.KEY not in wire.from_node:
            return False
        material.node_tree.links.remove(wire)
    socket.default_value = value
    return True


class LTMD_OT_preset(setup.OnObjects, bpy.types.Operator):
    """Make the active material of each selected object look like a known one"""

    bl_idname = "ltmd.preset"
    bl_label = "Apply Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Preset", description="The material to take", items=presets.items())

    def work(self, obj):
        material = obj.active_material
        if not surface.is_set_up(material):
            raise source.SourceError(
                f"The active material of {obj.name} is not set up: press Set Up LTMD first"
            )
        if not is_local(material):
            raise source.SourceError(f"{material.name}: {NODES_REFUSAL}")
        return apply(material, presets.PRESETS[self.preset])


def register():
    bpy.utils.register_class(LTMD_OT_preset)


def unregister():
    bpy.utils.unregister_class(LTMD_OT_preset)
