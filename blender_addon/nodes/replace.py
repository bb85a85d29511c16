# SPDX-License-Identifier: GPL-3.0-or-later
"""Show another group in a group node. Links, values and animation follow the sockets' names: the
identifiers by which Blender would match them are those of another group.
"""

import re

import bpy

from . import ensure


def replace(node, module, renamed=None):
    """Let `node` show the group of `module`; renamed: {old socket name: new one}.

    Sockets that only the new group has get its defaults. Raises RuntimeError if the group cannot be
    made; then nothing is changed.
    """
    group = ensure(module)
    if node.node_tree == group:
        return
    renamed = renamed or {}

    def new_name(name):
        return renamed.get(name, name)

    tree = node.id_data
    before = node.node_tree.name if node.node_tree else ""
    order = [new_name(socket.name) for socket in node.inputs]
    values = {new_name(s.name): (s.type, _value(s)) for s in node.inputs}
    hidden = {new_name(s.name) for s in (*node.inputs, *node.outputs) if s.hide}
    sources = {new_name(s.name): _ends(s)[0] for s in node.inputs if s.is_linked}
    targets = {new_name(s.name): _ends(s) for s in node.outputs}
    for wire in [wire for s in (*node.inputs, *node.outputs) for wire in s.links]:
        tree.links.remove(wire)

    node.node_tree = group
    defaults = {
        item.identifier: getattr(item, "default_value", None)
        for item in group.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT"
    }
    for socket in node.inputs:
        kind, value = values.get(socket.name, (None, None))
        if kind != socket.type:
            value = defaults.get(socket.identifier)
        if value is not None:
            socket.default_value = value
        if socket.name in sources:
            other, muted = sources[socket.name]
            tree.links.new(other, socket).is_muted = muted
    for socket in node.outputs:
        for other, muted in targets.get(socket.name, ()):
            tree.links.new(socket, other).is_muted = muted
    for socket in (*node.inputs, *node.outputs):
        socket.hide = socket.name in hidden
    _move_animation(tree, node.name, order, [socket.name for socket in node.inputs])
    if node.label in ("", before, before.split(".")[0]):
        node.label = module.NAME
    if before and node.name.split(".")[0] == before.split(".")[0]:
        node.name = module.NAME


def _ends(socket):
    """[(the socket at the other end, is the link muted)]"""
    return [(w.to_socket if socket.is_output else w.from_socket, w.is_muted) for w in socket.links]


def _value(socket):
    value = getattr(socket, "default_value", None)
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def _move_animation(tree, name, old, new):
    """Animation names a socket by its place in the list."""
    data = tree.animation_data
    if data is None:
        return
    quoted = re.escape(bpy.utils.escape_identifier(name))
    path = re.compile(rf'(nodes\["{quoted}"\]\.inputs\[)(\d+)(\].*)')
    for curve in list(curves(data)):
        match = path.fullmatch(curve.data_path)
        if match and int(match[2]) < len(old) and old[int(match[2])] in new:
            place = new.index(old[int(match[2])])
            curve.data_path = f"{match[1]}{place}{match[3]}"


def curves(data):
    """F-curves of the drivers, the action and the NLA strips of animation data."""
    yield from data.drivers
    uses = [(data.action, data.action_slot)]
    uses += [(s.action, s.action_slot) for track in data.nla_tracks for s in track.strips]
    seen = set()
    for action, slot in uses:
        if action is None or slot is None or (action, slot.identifier) in seen:
            continue
        seen.add((action, slot.identifier))
        for layer in action.layers:
            for strip in layer.strips:
                bag = strip.channelbag(slot)
                if bag:
                    yield from bag.fcurves
