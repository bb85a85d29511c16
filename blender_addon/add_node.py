# SPDX-License-Identifier: GPL-3.0-or-later
"""Add > LTMD in the shader editor."""

import bpy
from bpy.props import EnumProperty, StringProperty

from . import device, nodes, versions
from .writable import NODES_REFUSAL, is_local

# None: a separator.
MENU = (
    "LTMD Glossy",
    "LTMD Conductor",
    "LTMD Dielectric",
    "LTMD Reference",
    None,
    "LTMD Live Tension",
    "LTMD Attribute Tension",
    "LTMD Tensor Tension",
    "LTMD Texture Tension",
    "LTMD Warp",
    None,
    "LTMD Parameters",
    "LTMD Normal",
    "LTMD Tension View",
)


def _items():
    return [(name, name, "") for name in MENU if name]


class LTMD_OT_add_node(bpy.types.Operator):
    """Add a node of LTMD to the material"""

    bl_idname = "ltmd.add_node"
    bl_label = "Add LTMD Node"
    bl_options = {"REGISTER", "UNDO"}

    node: EnumProperty(name="Node", description="The node to add", items=_items())
    material: StringProperty(
        name="Material",
        description="Name of the material; empty: the one in the shader editor",
        options={"SKIP_SAVE"},
    )

    def invoke(self, context, event):
        space = context.space_data
        in_editor = getattr(space, "tree_type", "") == "ShaderNodeTree" and not self.material
        if in_editor and context.region.type == "WINDOW":
            space.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        done = self.execute(context)
        if in_editor and "FINISHED" in done:
            # Sticks to the pointer until a click.
            bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return done

    def execute(self, context):
        tree, owner, place = self._target(context)
        if tree is None or not is_local(owner):
            words = (
                NODES_REFUSAL.capitalize()
                if tree
                else "There is no shader editor with a material here: give the name of a material "
                "with nodes"
            )
            self.report({"ERROR"}, words)
            return {"CANCELLED"}
        known = versions.modules()
        name = self.node
        if not device.uses_osl(context) and f"{name} (no OSL)" in known:
            name = f"{name} (no OSL)"
        try:
            node = nodes.group_node(tree, known[name])
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for other in tree.nodes:
            other.select = other == node
        tree.nodes.active = node
        node.location = place
        return {"FINISHED"}

    def _target(self, context):
        """(tree or None, the data-block that has it, place of the node)"""
        if self.material:
            material = bpy.data.materials.get(self.material)
            return material and material.node_tree, material, (0, 0)
        space = context.space_data
        if getattr(space, "tree_type", "") != "ShaderNodeTree":
            return None, None, None
        tree = space.edit_tree
        # A tree inside a material does not say that it is overridden.
        owner = space.id if tree and tree.is_embedded_data else tree
        return tree, owner, space.cursor_location


class LTMD_MT_add(bpy.types.Menu):
    bl_label = "LTMD"

    def draw(self, context):
        for name in MENU:
            if name is None:
                self.layout.separator()
            else:
                label = name.removeprefix("LTMD ")
                self.layout.operator("ltmd.add_node", text=label).node = name


def _draw(menu, context):
    menu.layout.menu("LTMD_MT_add")


def register():
    bpy.utils.register_class(LTMD_OT_add_node)
    bpy.utils.register_class(LTMD_MT_add)
    bpy.types.NODE_MT_shader_node_add_all.append(_draw)


def unregister():
    bpy.types.NODE_MT_shader_node_add_all.remove(_draw)
    bpy.utils.unregister_class(LTMD_MT_add)
    bpy.utils.unregister_class(LTMD_OT_add_node)
