# SPDX-License-Identifier: Apache-2.0
"""For scripts in a child process: materials, and everything that is in their node trees."""

import json

import bpy
from blender_process import mesh_object

__all__ = ["counts", "cube", "dump", "json", "new_material", "principled", "value"]


def cube(name="Cube", uv=True):
    """A cube of side 2; each face has its own place in UV space."""
    c = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    f = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    uvs = [
        (k % 3 / 3 + x / 4, k // 3 / 2 + y / 3)
        for k in range(6)
        for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    return mesh_object(name, c, f, uvs if uv else None)


def value(socket):
    """The socket's value as JSON, None for a shader."""
    try:
        v = socket.default_value
    except AttributeError:
        return None
    return list(v) if hasattr(v, "__len__") and not isinstance(v, str) else v


def dump(material):
    """Everything in the node tree that a user could see changed."""
    tree = material.node_tree
    return json.dumps(
        {
            "use_nodes": material.use_nodes,
            "active": tree.nodes.active.name if tree.nodes.active else "",
            "nodes": sorted(
                [
                    n.name,
                    n.bl_idname,
                    n.label,
                    list(n.location),
                    n.mute,
                    getattr(n, "target", ""),
                    getattr(n, "is_active_output", ""),
                    n.select,
                    [[s.name, value(s)] for s in n.inputs],
                ]
                for n in tree.nodes
            ),
            "links": sorted(
                [w.from_node.name, w.from_socket.identifier, w.to_node.name, w.to_socket.identifier]
                for w in tree.links
            ),
        },
        sort_keys=True,
        default=str,
    )


def counts():
    """Data-blocks that a set-up could leave behind."""
    return [len(bpy.data.node_groups), len(bpy.data.texts), len(bpy.data.materials)]


def principled(material):
    return next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")


def new_material(name, obj):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    if obj:
        obj.data.materials.append(material)
    return material
