# SPDX-License-Identifier: Apache-2.0
"""Objects to bake, made inside the child process, and what a render would show of them.

evaluated() gets there another way than the add-on: through the viewport's depsgraph, with the
viewport's settings made equal to the render's.
"""

import bpy
import numpy as np
from blender_process import link
from mathutils import Matrix


def monkey(name="Suzanne"):
    """Suzanne at the origin, one UV map without overlap, no modifiers."""
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.name = name
    return obj


def sheet(name="Sheet", cells=4, uv_scale=1.0, uv_offset=(0.0, 0.0), uv=True):
    """A square grid of `cells` quads a side in the xy plane, its UVs the square, moved."""
    grid = np.linspace(0.0, 1.0, cells + 1)
    points = np.array([(x, y, 0.0) for y in grid for x in grid])
    faces = [
        (a, a + 1, a + cells + 2, a + cells + 1)
        for a in (row * (cells + 1) + column for row in range(cells) for column in range(cells))
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces)
    if uv:
        corners = points[np.array(faces).ravel(), :2] * uv_scale + uv_offset
        layer = mesh.uv_layers.new(name="UVMap")
        layer.uv.foreach_set("vector", corners.astype(np.float32).ravel())
    return link(bpy.data.objects.new(name, mesh))


def keyed_shape(obj, change, frames=(1, 4)):
    """A shape key with the points change(x), from 0 to 1 over the frames, linear."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name=f"Key {len(obj.data.shape_keys.key_blocks)}")
    points = np.empty(3 * len(key.data), np.float32)
    key.data.foreach_get("co", points)
    key.data.foreach_set("co", change(points.reshape(-1, 3)).astype(np.float32).ravel())
    for frame, value in zip(frames, (0.0, 1.0), strict=True):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return key


def armature(obj, frames=(1, 4)):
    """Two bones; the upper one turns and stretches between the frames and moves points z > 0."""
    data = bpy.data.armatures.new("Armature")
    rig = link(bpy.data.objects.new("Armature", data))
    bpy.ops.object.mode_set(mode="EDIT")
    for name, z in (("low", -1.0), ("high", 0.0)):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, z), (0, 0, z + 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, side in (("low", -1), ("high", 1)):
        group = obj.vertex_groups.new(name=name)
        for vertex in obj.data.vertices:
            weight = min(max(0.5 + side * vertex.co.z, 0.0), 1.0)
            if weight > 0:
                group.add([vertex.index], weight, "REPLACE")
    pose = rig.pose.bones["high"]
    pose.rotation_mode = "XYZ"
    for frame, angle, size in zip(frames, (0.0, 0.5), (1.0, 1.3), strict=True):
        pose.rotation_euler = (angle, 0, 0)
        pose.scale = (1, size, 1)
        pose.keyframe_insert("rotation_euler", frame=frame)
        pose.keyframe_insert("scale", frame=frame)
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    bpy.context.view_layer.objects.active = obj
    return modifier


def subsurf(obj, levels=0, render_levels=1):
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = levels, render_levels
    return modifier


def geometry_nodes(obj, name, node_type, **inputs):
    """A Geometry Nodes modifier of a single node."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    first, last = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    node = tree.nodes.new(node_type)
    for socket, value in inputs.items():
        node.inputs[socket].default_value = value
    tree.links.new(first.outputs[0], node.inputs[0])
    tree.links.new(node.outputs[0], last.inputs[0])
    modifier = obj.modifiers.new(name, "NODES")
    modifier.node_group = tree
    return modifier


def evaluated(obj, frame):
    """What a render at this frame shows, as arrays: positions, faces, UVs and the object's 3x3."""
    bpy.context.scene.frame_set(frame)
    before = obj.hide_viewport
    obj.hide_viewport = False
    levels = {m: m.levels for m in obj.modifiers if m.type == "SUBSURF"}
    for modifier in levels:
        modifier.levels = modifier.render_levels
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    found = obj.evaluated_get(depsgraph)
    mesh = found.data
    mesh.calc_loop_triangles()
    arrays = {
        "positions": np.array([tuple(v.co) for v in mesh.vertices]),
        "corner_vert": np.array([corner.vertex_index for corner in mesh.loops]),
        "triangles": np.array([tuple(t.loops) for t in mesh.loop_triangles]),
        "corner_uv": np.array([tuple(uv.vector) for uv in mesh.uv_layers.active.uv]),
        "matrix": np.array(Matrix(found.matrix_world).to_3x3()),
    }
    for modifier, level in levels.items():
        modifier.levels = level
    obj.hide_viewport = before
    return arrays


def at_rest(obj, frame=1):
    """The same without keys and deforming modifiers, on a copy that is removed again."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.animation_data_clear()
    bpy.context.scene.collection.objects.link(copy)
    if copy.data.shape_keys is not None:
        copy.data.shape_keys.animation_data_clear()
        for key in copy.data.shape_keys.key_blocks:
            key.value = 0.0
    for modifier in list(copy.modifiers):
        if modifier.type in {"ARMATURE", "LATTICE", "SIMPLE_DEFORM", "CLOTH"}:
            copy.modifiers.remove(modifier)
    arrays = evaluated(copy, frame)
    bpy.data.objects.remove(copy)
    return arrays


def bake(objects, frames, folder, **settings):
    """Bake objects through the add-on's own steps; return the finished Bake."""
    from blender_addon import bake as baking

    stop = settings.pop("stop", None)
    progress = settings.pop("progress", None)
    values = {"width": 64, "height": 64, "margin": 2, "folder": str(folder), **settings}
    scene = bpy.context.scene
    layer = baking.render_layer(scene, bpy.context.view_layer, objects)
    settings = baking.Settings(list(objects), list(frames), **values)
    work = baking.Bake(scene, layer, settings, progress)
    work.prepare()
    work.run(stop)
    work.finish()
    return work


def refusal(*arguments, **settings):
    """The sentence with which bake() refuses, or "" if it does not."""
    from blender_addon import bake as baking

    try:
        bake(*arguments, **settings)
    except (baking.Refused, baking.WriteFailure) as error:
        return f"{type(error).__name__}: {error}"
    return ""
