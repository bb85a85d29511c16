# SPDX-License-Identifier: GPL-3.0-or-later
"""The node groups, one per file. Each module has NAME, VERSION and build(tree), those of modifiers
TREE = "GeometryNodeTree" too.

Socket names never change: materials in saved files are linked by them. A group of another version
is left alone, so that opening an old file never changes its pictures.
"""

import bpy

GROUP_KEY = "ltmd_group"
VERSION_KEY = "ltmd_version"


def ensure(module):
    """The file's own group of this version; made if it is not there."""
    for tree in bpy.data.node_groups:
        if (
            tree.library is None
            and tree.get(GROUP_KEY) == module.NAME
            and tree.get(VERSION_KEY) == module.VERSION
        ):
            return tree
    tree = bpy.data.node_groups.new(module.NAME, getattr(module, "TREE", "ShaderNodeTree"))
    tree[GROUP_KEY] = module.NAME
    tree[VERSION_KEY] = module.VERSION
    try:
        module.build(tree)
    except Exception:
        bpy.data.node_groups.remove(tree)
        raise
    return tree


def without_osl(group):
    """Is the group one of those made of stock nodes alone?"""
    return group.get(GROUP_KEY, "").endswith(" (no OSL)")


def group_node(tree, module):
    """A new node in `tree` that shows the group. Raises RuntimeError; then there is none."""
    group = ensure(module)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.label = node.name = module.NAME
    node.width = 200
    return node


def remove_unused():
    """Remove the groups that nothing uses any more."""
    for tree in list(bpy.data.node_groups):
        if tree.library is None and GROUP_KEY in tree and tree.users == 0:
            bpy.data.node_groups.remove(tree)


def add_input(tree, name, kind, description, default=None, low=None, high=None, **more):
    """An input of the group; kind is Float, Int, Bool, Color, Vector or Shader."""
    socket = tree.interface.new_socket(name, in_out="INPUT", socket_type=f"NodeSocket{kind}")
    socket.description = description
    if more.get("subtype"):
        socket.subtype = more.pop("subtype")
    if default is not None:
        socket.default_value = default
    if low is not None:
        socket.min_value = low
    if high is not None:
        socket.max_value = high
    for key, value in more.items():
        setattr(socket, key, value)
    return socket


def add_output(tree, name, kind, description):
    socket = tree.interface.new_socket(name, in_out="OUTPUT", socket_type=f"NodeSocket{kind}")
    socket.description = description
    return socket


def add_tension_outputs(tree):
    """What every source of tension gives."""
    add_output(
        tree,
        "Tension",
        "Vector",
        "How the surface is deformed from its rest state, for LTMD Glossy. 1, 0, 1 is the rest "
        "state",
    )
    add_output(tree, "Tangent", "Vector", "Direction of the UV map's U on the surface")


def add_tension_inputs(tree):
    """What takes a source of tension."""
    add_input(
        tree,
        "Tension",
        "Vector",
        "How the surface is deformed, from one of the LTMD tension nodes. 1, 0, 1 is the rest "
        "state",
        (1.0, 0.0, 1.0),
    )
    add_input(
        tree,
        "Tangent",
        "Vector",
        "Direction of the UV map's U on the surface, from the same node as the tension",
        (0.0, 0.0, 0.0),
        hide_value=True,
    )


def add_uv_input(tree, description):
    """The UV map of a source of tension."""
    add_input(tree, "UV", "Vector", description, (0.0, 0.0, 0.0), hide_value=True)


def add_attribute(tree, name, place):
    """The Vector of an attribute of the mesh, (0, 0, 0) where the mesh has none."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = node.label = name
    node.location = place
    return node.outputs["Vector"]


def link_script(tree, start, script, parameters=()):
    """Link the group's inputs to a shader's parameters of the same names without spaces.

    parameters: {input: parameter}, where the name is another.
    """
    named = dict(parameters)
    for socket in start.outputs:
        if socket.name:
            name = named.get(socket.name, socket.name.replace(" ", ""))
            tree.links.new(socket, script.inputs[name])


def ends(tree, x=600):
    """The group's input and output nodes."""
    start = tree.nodes.new("NodeGroupInput")
    start.location = (-x, 0)
    end = tree.nodes.new("NodeGroupOutput")
    end.location = (x, 0)
    return start, end
