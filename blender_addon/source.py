# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a set-up material gets the tension from: live, a modifier, or baked images."""

import bpy
import numpy as np

from . import modifier, nodes, rest_state, surface
from .nodes import (
    attribute_tension,
    attribute_tension_no_osl,
    live_tension,
    tensor_tension,
    tensor_tension_no_osl,
    texture_tension,
    texture_tension_no_osl,
)
from .nodes.rest_positions import REST_ATTRIBUTE
from .writable import is_local, is_writable

# Modifiers that only move vertices, or copy triangles unchanged: a point attribute of the rest
# positions stays right behind them. Anything else makes new shapes, where only the Generated
# coordinates are subdivided like the surface itself.
MOVING = {
    "ARMATURE", "CAST", "CLOTH", "COLLISION", "CORRECTIVE_SMOOTH", "CURVE", "DATA_TRANSFER",
    "DISPLACE", "DYNAMIC_PAINT", "HOOK", "LAPLACIANDEFORM", "LAPLACIANSMOOTH", "LATTICE",
    "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "NORMAL_EDIT", "PARTICLE_SYSTEM",
    "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "SURFACE", "SURFACE_DEFORM",
    "UV_PROJECT", "UV_WARP", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX",
    "VERTEX_WEIGHT_PROXIMITY", "VOLUME_DISPLACE", "WARP", "WAVE", "WEIGHTED_NORMAL",
}  # fmt: skip
LONGEST = 1048574  # Blender's highest frame
FRAMES_KEY = "ltmd_frames"  # of an Image Texture node: first and last baked frame
COPYING = {"ARRAY", "EDGE_SPLIT", "MASK", "MIRROR", "NODES", "TRIANGULATE"}


# The group that gives the tension, for the sources measured at every frame.
GROUPS = {"LIVE": live_tension, "ATTRIBUTE": attribute_tension, "TENSOR": tensor_tension}
# A Blender built without OSL compiles no shader. (Where only the device has none, device.match()
# exchanges the groups.)
COMPILES = bpy.app.build_options.cycles_osl
_TWINS = {
    attribute_tension: attribute_tension_no_osl,
    tensor_tension: tensor_tension_no_osl,
    texture_tension: texture_tension_no_osl,
}


def group_for(module):
    """The group, or its twin if this Blender cannot make the group. Raises SourceError."""
    if COMPILES:
        return module
    if module not in _TWINS:
        raise SourceError(
            "Live tension needs Open Shading Language, which this Blender is built without: choose "
            "Attribute or Tensor as source, or bake"
        )
    return _TWINS[module]


class SourceError(Exception):
    """The source cannot be used; str() says why and what to do."""


def needs_generated(obj):
    """Does a modifier of the object subdivide or rebuild the surface in renders?"""
    return any(m.show_render and m.type not in MOVING | COPYING for m in obj.modifiers)


def _geometry_nodes(obj):
    """Does Geometry Nodes, other than ours, change the object in renders?"""
    return any(
        m.show_render and m.type == "NODES" and not rest_state.is_ours(m) for m in obj.modifiers
    )


def _needs_modifier(obj):
    """Must a modifier bring the rest positions to live tension?

    Generated coordinates are the basis, and behind deforming Geometry Nodes not even that.
    """
    return needs_generated(obj) and (obj.ltmd.rest_mode != "BASIS" or _geometry_nodes(obj))


def live_limits(obj):
    """What live tension cannot do on this object, as a sentence, or None."""
    if modifier.find(obj):
        return modifier.limits(obj)
    if not needs_generated(obj):
        stale = REST_ATTRIBUTE not in obj.data.attributes
        if stale and obj.ltmd.source == "LIVE":
            return "Viewport: shown at rest, as the rest state is not stored in the mesh"
        return None
    if _needs_modifier(obj) or REST_ATTRIBUTE in obj.data.attributes:
        return "The modifiers have changed: press Set Up LTMD again"
    return "The deformation shows in final renders; the viewport shows this object at rest"


def modifier_limits(obj):
    """What the attribute and the tensor source cannot show on this object, or None."""
    if obj.ltmd.source == "ATTRIBUTE" and not obj.data.uv_layers:
        return "The mesh has no UV map: choose the Tensor source"
    return modifier.limits(obj)


def texture_limits(obj, frame):
    """What the baked images cannot show at this frame, as a sentence, or None."""
    for material in materials(obj):
        for node in surface.our_nodes(material, "source"):
            if FRAMES_KEY in node and not node[FRAMES_KEY][0] <= frame <= node[FRAMES_KEY][1]:
                first, last = node[FRAMES_KEY]
                return f"Frame {frame} is shown at rest: baked are the frames {first} to {last}"
    return None


def limits(obj, frame):
    """What the object's source cannot show at this frame, as a sentence, or None."""
    if obj.ltmd.source == "LIVE":
        return live_limits(obj)
    if obj.ltmd.source == "TEXTURE":
        return texture_limits(obj, frame)
    return modifier_limits(obj) if obj.ltmd.source in modifier.STORED else None


def rest_positions(obj):
    """The object's rest state as float32[vertices, 3] in its own space. Raises SourceError."""
    settings = obj.ltmd
    mesh = obj.data
    if settings.rest_mode == "BASIS":
        return _basis(mesh)
    if settings.rest_mode == "OBJECT":
        other = settings.rest_object
        if other is None:
            raise SourceError(f"{obj.name}: choose the rest object")
        positions = _basis(other.data)
        label = other.name
    else:
        positions = _positions_at(obj, settings.rest_frame)
        label = f"frame {settings.rest_frame}"
    if len(positions) != len(mesh.vertices):
        raise SourceError(
            f"{obj.name} has {len(mesh.vertices)} vertices but {label} has {len(positions)}: live "
            "tension needs the same mesh in both; bake the tension instead"
        )
    return positions


def _basis(mesh):
    data = mesh.shape_keys.reference_key.points if mesh.shape_keys else mesh.vertices
    positions = np.empty(len(data) * 3, np.float32)
    data.foreach_get("co", positions)
    return positions.reshape(-1, 3)


def _positions_at(obj, frame):
    """The mesh's own vertices as the deforming modifiers leave them at the frame."""
    moving = MOVING | rest_state.DEFORMING | {"NODES"}
    making = [m for m in obj.modifiers if m.type not in moving and m.show_viewport]
    after = obj.modifiers[obj.modifiers.find(making[0].name) :] if making else ()
    if any(m.type in rest_state.DEFORMING and m.show_viewport for m in after):
        raise SourceError(
            f"{obj.name}: a frame as rest state needs the deforming modifiers before "
            f"{making[0].name}; move them up, or bake the tension"
        )
    scene = bpy.context.scene
    now, part = scene.frame_current, scene.frame_subframe
    try:
        for m in making:
            m.show_viewport = False
        scene.frame_set(frame)
        evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        positions = np.empty(len(evaluated.vertices) * 3, np.float32)
        evaluated.vertices.foreach_get("co", positions)
    finally:
        for m in making:
            m.show_viewport = True
        scene.frame_set(now, subframe=part)
    return positions.reshape(-1, 3)


def measure(obj, kind):
    """Let the object have what the source needs of it; return sentences for the user.

    kind: one of GROUPS. Raises SourceError.
    """
    if is_writable(obj.data):
        modifier.clear_stored(obj.data)
    if kind == "LIVE":
        return _store_rest(obj)
    uv_map = obj.ltmd.uv_map or rest_state.default_uv_map(obj.data)
    if kind == "ATTRIBUTE" and uv_map not in obj.data.uv_layers:
        raise SourceError(
            f"{obj.name}: the Attribute source needs a UV map; unwrap the mesh, or choose Tensor"
        )
    modifier.add(obj, kind, rest_positions(obj), uv_map)
    if is_writable(obj.data) and not has_live_twin(obj):
        clear_rest(obj.data)
    limit = modifier.limits(obj)
    return [f"{obj.name}: {limit}"] if limit else []


def has_live_twin(obj):
    """Does another object with the same mesh read its rest state?"""
    return any(
        other.data == obj.data and other != obj and other.ltmd.source == "LIVE"
        for other in bpy.data.objects
    )


def store_frame(obj):
    """Keep this frame's tension in the mesh, not measuring any more. Raises SourceError."""
    if obj.ltmd.source not in modifier.STORED:
        raise SourceError(
            f"{obj.name}: choose the source Attribute or Tensor first, which can be stored"
        )
    if not is_local(obj.data):
        raise SourceError(f"{obj.name}: linked mesh data cannot store a tension; bake instead")
    if obj.data.users > 1:
        raise SourceError(
            f"{obj.name} shares its mesh with another object: make it single-user, as each would "
            "show the tension of this one"
        )
    measure(obj, obj.ltmd.source)
    if not modifier.alike(obj) or not modifier.store(obj, obj.ltmd.source):
        raise SourceError(
            f"{obj.name}: modifiers change the mesh, so it has no place for each value; apply the "
            "ones that make geometry, or keep measuring every frame"
        )
    return [f"{obj.name}: {modifier.limits(obj)}"]


def _store_rest(obj):
    """Bring the rest positions to the object as it needs them."""
    mesh = obj.data
    if _needs_modifier(obj):
        modifier.add(obj, "LIVE", rest_positions(obj))
        limit = modifier.limits(obj)
        return [f"{obj.name}: {limit}"] if limit else []
    modifier.remove(obj)
    if needs_generated(obj):
        if is_writable(mesh):
            clear_rest(mesh)
        return [f"{obj.name}: {live_limits(obj)}"]
    if not is_writable(mesh):
        if obj.ltmd.rest_mode != "BASIS":
            modifier.add(obj, "LIVE", rest_positions(obj))
            return []
        return [f"{obj.name}: the deformation shows in final renders only"]
    positions = rest_positions(obj)
    attribute = mesh.attributes.get(REST_ATTRIBUTE)
    if attribute and (attribute.data_type, attribute.domain) != ("FLOAT_VECTOR", "POINT"):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(REST_ATTRIBUTE, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", positions.ravel())
    mesh.update_tag()
    return []


def clear_rest(mesh):
    attribute = mesh.attributes.get(REST_ATTRIBUTE)
    if attribute:
        mesh.attributes.remove(attribute)


def materials(obj):
    """The set-up materials of the object, each once."""
    return list(
        dict.fromkeys(s.material for s in obj.material_slots if surface.is_set_up(s.material))
    )


def users(material):
    """The objects that show the material."""
    return [
        obj
        for obj in bpy.data.objects
        if any(slot.material == material for slot in obj.material_slots)
    ]


def own_copy(obj, material):
    """A copy of the material for this object alone, in the slots that showed it."""
    copy = material.copy()
    copy.name = f"{material.name} {obj.name}"
    assign(obj, material, copy)
    return copy


def assign(obj, old, new):
    """Replace a material in the object's slots without touching other users of its mesh."""
    for slot in obj.material_slots:
        if slot.material == old:
            if slot.link == "DATA" and (obj.data.users > 1 or not is_writable(obj.data)):
                slot.link = "OBJECT"
            slot.material = new


def switch(obj, material, kind, together=()):
    """Wire a set-up material to a source in GROUPS; return sentences for the user.

    A material that other objects show with another source becomes a copy for obj, unless they are
    among the ones that are switched `together`.
    """
    told = []
    others = [
        other.name
        for other in users(material)
        if other.ltmd.source not in (kind, "NONE") and other != obj and other not in together
    ]
    if others:
        shared, material = material, own_copy(obj, material)
        told.append(_told_of_copy(obj, shared, others))
    tree = material.node_tree
    clear(material)
    lobe, box = surface.lobe(material), surface.frame(material)
    uv = surface.own(tree.nodes.new("ShaderNodeUVMap"), "source", box)
    uv.uv_map = obj.ltmd.uv_map
    tension = surface.own(nodes.group_node(tree, group_for(GROUPS[kind])), "source", box)
    _place(lobe, tension, uv)
    tree.links.new(uv.outputs["UV"], tension.inputs["UV"])
    _connect(material, tension)
    return told


def _told_of_copy(obj, shared, others):
    return (
        f"{obj.name} has its own copy of {shared.name} now, as its source is its own; "
        f"{', '.join(others)} keep{'s' if len(others) == 1 else ''} {shared.name}"
    )


def switch_to_texture(obj, material, files):
    """Read baked images; return sentences for the user.

    files: {udim: {"path": file of the first frame, "frames": sorted numbers, ...}}. Files are
    numbered like the scene's frames. A material that other objects show becomes a copy for obj.
    """
    try:
        nodes.ensure(group_for(texture_tension))
    except RuntimeError as error:
        return [f"The material {material.name} stays as it is: {error}"]
    told = []
    others = [other.name for other in users(material) if other != obj]
    if others:
        shared, material = material, own_copy(obj, material)
        told.append(_told_of_copy(obj, shared, others))
    tree = material.node_tree
    clear(material)
    lobe, box = surface.lobe(material), surface.frame(material)
    uv = surface.own(tree.nodes.new("ShaderNodeUVMap"), "source", box)
    uv.uv_map = obj.ltmd.uv_map or rest_state.default_uv_map(obj.data)
    uv.location = (lobe.location.x - 1100, lobe.location.y)
    previous = None
    for index, (udim, entry) in enumerate(sorted(files.items())):
        udim = int(udim)
        x, y = (udim - 1001) % 10, (udim - 1001) // 10
        shifted = uv.outputs["UV"]
        if (x, y) != (0, 0):
            shift = surface.own(tree.nodes.new("ShaderNodeVectorMath"), "source", box)
            shift.operation = "SUBTRACT"
            shift.inputs[1].default_value = (x, y, 0.0)
            shift.location = (lobe.location.x - 900, lobe.location.y - 300 * index)
            tree.links.new(shifted, shift.inputs[0])
            shifted = shift.outputs["Vector"]
        picture = surface.own(tree.nodes.new("ShaderNodeTexImage"), "source", box)
        picture.location = (lobe.location.x - 700, lobe.location.y - 300 * index)
        _show_sequence(picture, _image(obj, udim, entry["path"]), entry["frames"])
        tree.links.new(shifted, picture.inputs["Vector"])
        tension = surface.own(nodes.group_node(tree, group_for(texture_tension)), "source", box)
        tension.location = (lobe.location.x - 300, lobe.location.y - 300 * index)
        tension.inputs["Tile"].default_value = udim
        tree.links.new(picture.outputs["Color"], tension.inputs["Image"])
        tree.links.new(uv.outputs["UV"], tension.inputs["UV"])
        if previous:
            tree.links.new(previous.outputs["Tension"], tension.inputs["Previous"])
        previous = tension
    if previous:
        _connect(material, previous)
    modifier.remove(obj)
    obj.ltmd.source = "TEXTURE"
    return told


def clear(material):
    """Remove the present source and the images that only it showed."""
    for node in surface.our_nodes(material, "source"):
        image = getattr(node, "image", None)
        material.node_tree.nodes.remove(node)
        if image and image.users == 0:
            bpy.data.images.remove(image)


def _connect(material, tension):
    for node in surface.takers(material):
        for name in ("Tension", "Tangent"):
            material.node_tree.links.new(tension.outputs[name], node.inputs[name])


def _place(lobe, tension, uv):
    tension.location = (lobe.location.x - 300, lobe.location.y)
    uv.location = (lobe.location.x - 550, lobe.location.y)


def _image(obj, udim, path):
    path = bpy.path.abspath(str(path))
    if bpy.data.filepath:
        try:
            path = bpy.path.relpath(path)
        except ValueError:
            pass  # another drive
    image = bpy.data.images.new(f"{obj.name} tension {udim}", 1, 1, float_buffer=True)
    # The source first: assigning it later would look for the file under the old settings.
    image.source = "SEQUENCE"
    image.filepath = path
    # Never a colour space name: "Non-Color" is unknown in other colour configurations.
    image.colorspace_settings.is_data = True
    image.alpha_mode = "CHANNEL_PACKED"
    return image


def _show_sequence(node, image, frames):
    node.image = image
    node.extension = "EXTEND"
    node.interpolation = "Linear"
    node.projection = "FLAT"
    user = node.image_user
    # The file's number is the scene's frame: start 1, no offset. With the longest duration a frame
    # after the last is a missing file, which shows the rest state, and not the last file again.
    user.frame_start = 1
    user.frame_offset = 0
    user.frame_duration = LONGEST
    node[FRAMES_KEY] = [min(frames), max(frames)]
    user.use_cyclic = False
    user.use_auto_refresh = True
