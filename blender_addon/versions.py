# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups of older versions in a file, and the operator Update LTMD Nodes.

Opening a file changes nothing: a group stays as the add-on that made it built it, until the user
asks for the present one.
"""

import functools
import importlib
import pkgutil

import bpy

from . import modifier, nodes
from .nodes import GROUP_KEY, VERSION_KEY
from .nodes.replace import replace
from .writable import is_local, is_writable


@functools.cache
def modules():
    """{name of the group: its module} of all groups the add-on makes."""
    found = {}
    for entry in pkgutil.iter_modules(nodes.__path__):
        module = importlib.import_module(f"{nodes.__name__}.{entry.name}")
        if hasattr(module, "VERSION"):
            found[module.NAME] = module
    return found


def older_groups():
    """The groups in use whose version is not the present one, those of libraries included."""
    present = {name: module.VERSION for name, module in modules().items()}
    return [
        tree
        for tree in bpy.data.node_groups
        if tree.users and tree.get(VERSION_KEY, 0) < present.get(tree.get(GROUP_KEY), 0)
    ]


def update():
    """Give every node and modifier of this file that shows an older group the present one.

    Returns (how many changed, names of the libraries whose groups stay as they are). Raises
    RuntimeError if a group cannot be made here; then nothing is changed.
    """
    known = modules()
    old = older_groups()
    try:
        for name in {tree[GROUP_KEY] for tree in old if is_writable(tree)}:
            nodes.ensure(known[name])
        owners = [(material, material.node_tree) for material in bpy.data.materials]
        owners += [(t, t) for t in bpy.data.node_groups if t.type == "SHADER" and t not in old]
        shown = [
            (owner, node, node.node_tree, replace)
            for owner, tree in owners
            if tree
            for node in tree.nodes
            if node.type == "GROUP" and node.node_tree in old
        ]
        shown += [
            (obj, m, m.node_group, modifier.replace_group)
            for obj in bpy.data.objects
            for m in obj.modifiers
            if m.type == "NODES" and m.node_group in old
        ]
        changed, left = 0, set()
        for owner, user, group, replace_in in shown:
            foreign = next((data for data in (owner, group) if not is_local(data)), None)
            if foreign is None:
                replace_in(user, known[group[GROUP_KEY]])
                changed += 1
            else:
                left.add(foreign.library.filepath if foreign.library else foreign.name)
    finally:
        nodes.remove_unused()
    return changed, sorted(left)


class LTMD_OT_update_nodes(bpy.types.Operator):
    """Replace LTMD nodes of older versions by the present ones; their links and values stay"""

    bl_idname = "ltmd.update_nodes"
    bl_label = "Update LTMD Nodes"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        try:
            changed, left = update()
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for name in left:
            self.report({"WARNING"}, f"Nodes of {name} stay as they are: update them in that file")
        if changed:
            self.report({"INFO"}, f"{changed} LTMD node{'s' * (changed > 1)} updated")
        elif not left:
            self.report({"INFO"}, "All LTMD nodes of this file are up to date")
        return {"FINISHED"} if changed else {"CANCELLED"}


def register():
    bpy.utils.register_class(LTMD_OT_update_nodes)


def unregister():
    bpy.utils.unregister_class(LTMD_OT_update_nodes)
