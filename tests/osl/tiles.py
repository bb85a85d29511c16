# SPDX-License-Identifier: Apache-2.0
"""For scripts in a child process: many small tiles in one picture, each seen at its own angle, with
its own material parameters, under the light of directional_light.

All pixels of a tile have one expected value, so that a tile's mean and standard error can be
compared with a number computed elsewhere.
"""

import bpy
import numpy as np
from blender_process import camera, cycles, mesh_object, render
from directional_light import GRADIENT, LAMP, LAMP_POWER, LAMP_STRENGTH, to_world
from shading import material

PIXELS = 8  # of a tile's side


def scene(views, samples, attributes):
    """A picture of tiles; return the tree and output of their material.

    views: [n, 3], the direction to the camera in each tile's frame (X, Y, normal). attributes: by
    name, [n] or [n, 3]; link_attribute() gives them to the material, and "x_axis", X.
    """
    views = np.asarray(views, float)
    side = int(np.ceil(np.sqrt(len(views))))
    vertices = []
    for index, view in enumerate(views):
        normal = to_world(view)[:, 2]
        column, row = index % side, side - 1 - index // side
        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        # The square as the camera sees it, on the plane through its middle.
        for x, y in corners if view[2] > 0 else corners[::-1]:
            depth = -((x - 0.5) * normal[0] + (y - 0.5) * normal[1]) / normal[2]
            vertices.append((column + x, row + y, depth))
    obj = mesh_object("Tiles", vertices, np.arange(4 * len(views)).reshape(-1, 4))
    axes = np.array([to_world(view)[:, 0] for view in views])
    for name, values in dict(attributes, x_axis=axes).items():
        values = np.asarray(values, np.float32)
        kind, field = ("FLOAT", "value") if values.ndim == 1 else ("FLOAT_VECTOR", "vector")
        store = obj.data.attributes.new(name, kind, "POINT")
        store.data.foreach_set(field, np.repeat(values, 4, axis=0).ravel())
    # Tiles do not see each other.
    for ray in ("glossy", "diffuse", "transmission", "shadow"):
        setattr(obj, f"visible_{ray}", False)
    cycles(PIXELS * side, PIXELS * side, samples)
    bpy.context.scene.cycles.filter_width = 1.0
    view = camera((side / 2, side / 2, 500), (side / 2, side / 2, 0), ortho_scale=side)
    view.data.clip_end = 1000
    _light()
    return material(obj)


def _light():
    world = bpy.data.worlds.new("Light")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    place = tree.nodes.new("ShaderNodeTexCoord")

    def math(operation, a, b):
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        tree.links.new(a, node.inputs[0])
        node.inputs[1].default_value = b
        return node.outputs[0]

    def along(vector):
        node = tree.nodes.new("ShaderNodeVectorMath")
        node.operation = "DOT_PRODUCT"
        node.inputs[1].default_value = vector
        tree.links.new(place.outputs["Generated"], node.inputs[0])
        return node.outputs["Value"]

    colour = tree.nodes.new("ShaderNodeCombineColor")
    colour.inputs[0].default_value = 1
    lamp = math("POWER", math("MAXIMUM", along(LAMP), 0), LAMP_POWER)
    tree.links.new(math("MULTIPLY", lamp, LAMP_STRENGTH), colour.inputs[1])
    tree.links.new(math("ADD", along(GRADIENT), 1), colour.inputs[2])
    background = tree.nodes.new("ShaderNodeBackground")
    tree.links.new(colour.outputs[0], background.inputs["Color"])
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])


def link_attribute(tree, name, socket):
    """For a whole number store it and a half: interpolated it may fall below it."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = name
    kind = "Vector" if socket.type == "VECTOR" else "Fac"
    tree.links.new(node.outputs[kind], socket)


def measure(count):
    """Mean and standard error of each tile, [count, 3] both."""
    picture = render()[..., :3].astype(float)
    side = picture.shape[0] // PIXELS
    tiles = picture.reshape(side, PIXELS, side, PIXELS, 3).swapaxes(1, 2)
    tiles = tiles.reshape(side * side, PIXELS * PIXELS, 3)[:count]
    return tiles.mean(axis=1), tiles.std(axis=1, ddof=1) / PIXELS
