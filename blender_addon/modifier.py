# SPDX-License-Identifier: GPL-3.0-or-later
"""The modifier that measures the deformation at every frame, and the object it measures from.

The rest state is a hidden object, in no collection: a copy of the mesh without shape keys, with the
modifiers that make geometry and none that move it. It is evaluated once, not at every frame, unless
the shape of the object's scale changes.
"""

import bpy
import numpy as np

from . import nodes, rest_state
from .nodes import (
    attribute_tension,
    rest_modifier,
    rest_position_modifier,
    tension_modifier,
    tensor_modifier,
    tensor_tension,
)

GROUPS = {
    "LIVE": rest_position_modifier,
    "ATTRIBUTE": tension_modifier,
    "TENSOR": tensor_modifier,
}
STORED = {
    "ATTRIBUTE": (attribute_tension.ATTRIBUTE,),
    "TENSOR": (tensor_tension.DIAGONAL, tensor_tension.OFF_DIAGONAL),
}
STORED_KEY = "ltmd_stored_frame"  # custom property of a mesh that has the values of one frame
REST_KEY = "ltmd_rest_of"  # custom property of a hidden object: the name of the measured one


def find(obj):
    """Our modifier of the object, or None."""
    names = {module.NAME for module in GROUPS.values()}
    return next(
        (
            m
            for m in obj.modifiers
            if m.type == "NODES" and m.node_group and m.node_group.get(nodes.GROUP_KEY) in names
        ),
        None,
    )


def rest_object(obj):
    """The hidden object our modifier measures from, or None."""
    found = find(obj)
    return _input(found, "Rest").get() if found else None


def add(obj, kind, positions, uv_map=""):
    """Measure from rest positions float32[vertices, 3]; kind is one of GROUPS.

    The group nodes must build, else RuntimeError and nothing is changed.
    """
    group = nodes.ensure(GROUPS[kind])
    rest_group = nodes.ensure(rest_modifier) if kind != "LIVE" else None
    remove(obj)
    ours = None
    for kept in rest_state.choices(obj):
        hidden = _hidden(obj, kept, positions)
        if rest_group:
            numbers = hidden.modifiers.new(rest_modifier.NAME, "NODES")
            numbers.node_group = rest_group
            _input(numbers, "UV Map").set(uv_map)
        if ours is None:
            ours = obj.modifiers.new(GROUPS[kind].NAME, "NODES")
            ours.node_group = group
            ours.show_group_selector = False
        former = _input(ours, "Rest").get()
        _input(ours, "Rest").set(hidden)
        if former is not None:
            _discard(former)
        bpy.context.view_layer.update()
        if alike(obj):
            break
    return ours


def remove(obj):
    """Take the modifier and its hidden object away."""
    found = find(obj)
    if found is None:
        return
    hidden = _input(found, "Rest").get()
    _input(found, "Rest").set(None)  # 5.x counts the user on
    obj.modifiers.remove(found)
    if hidden is not None and REST_KEY in hidden and hidden.users == 0:
        _discard(hidden)


def alike(obj):
    """Has the evaluated rest state the faces of the evaluated mesh?"""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    hidden = rest_object(obj)
    if hidden is None:
        return False
    mesh, rest = (o.evaluated_get(depsgraph).data for o in (obj, hidden))
    return (len(mesh.vertices), len(mesh.loops)) == (len(rest.vertices), len(rest.loops))


def store(obj, kind):
    """Keep this frame's values as attributes of the mesh and take the modifier away.

    kind: "ATTRIBUTE" or "TENSOR". Returns False, and changes nothing, if the evaluated mesh is not
    the object's own: then there is no element to keep a value in.
    """
    mesh = obj.data
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    if (len(mesh.vertices), len(mesh.loops)) != (len(evaluated.vertices), len(evaluated.loops)):
        return False
    for name in STORED[kind]:
        measured = evaluated.attributes[name]
        values = np.empty(len(measured.data) * 3, np.float32)
        measured.data.foreach_get("vector", values)
        kept = mesh.attributes.get(name)
        if kept is not None:
            mesh.attributes.remove(kept)
        kept = mesh.attributes.new(name, "FLOAT_VECTOR", measured.domain)
        kept.data.foreach_set("vector", values)
    mesh[STORED_KEY] = bpy.context.scene.frame_current
    remove(obj)
    return True


def clear_stored(mesh):
    """Remove what store() kept in the mesh."""
    if STORED_KEY in mesh:
        for name in sum(STORED.values(), ()):
            if name in mesh.attributes:
                mesh.attributes.remove(mesh.attributes[name])
        del mesh[STORED_KEY]


def limits(obj):
    """What the modifier cannot show on this object, as a sentence, or None."""
    ours = find(obj)
    if ours is None and STORED_KEY in obj.data:
        return f"The tension of frame {obj.data[STORED_KEY]} is stored and shown at every frame"
    if ours is None:
        return "The modifier that measures is gone: press Set Up LTMD again"
    hidden = rest_object(obj)
    if hidden is None or not alike(obj):
        return "Shown at rest, as the mesh or its modifiers have changed: press Set Up LTMD again"
    if obj.modifiers[-1] != ours:
        return f"Move the modifier {ours.name} to the end: what follows it is not measured"
    if not (hidden.constraints or np.allclose(_shape(obj), _shape(hidden), atol=1e-3)):
        return "The object's scale has changed its proportions: press Set Up LTMD again"
    if _adaptive(obj):
        return f"The modifier {ours.name} switches adaptive subdivision off"
    return None


def replace_group(modifier, module):
    """Show another group in a Geometry Nodes modifier; inputs of the same names keep their values.

    Raises RuntimeError if the group cannot be made.
    """

    def names():
        items = modifier.node_group.interface.items_tree
        return [
            i.name for i in items if i.in_out == "INPUT" and i.socket_type != "NodeSocketGeometry"
        ]

    group = nodes.ensure(module)
    values = {name: _input(modifier, name).get() for name in names()}
    modifier.node_group = group
    for name in names():
        if name in values:
            _input(modifier, name).set(values[name])


class _input:
    """An input of a Geometry Nodes modifier by its name."""

    def __init__(self, modifier, name):
        self.modifier = modifier
        self.identifier = next(
            item.identifier
            for item in modifier.node_group.interface.items_tree
            if item.name == name and item.in_out == "INPUT"
        )

    def _holder(self):
        # 5.x keeps inputs as properties with a value.
        properties = getattr(self.modifier, "properties", None)
        return getattr(properties.inputs, self.identifier) if properties else None

    def get(self):
        holder = self._holder()
        return holder.value if holder else self.modifier.get(self.identifier)

    def set(self, value):
        holder = self._holder()
        if holder:
            holder.value = value
        else:
            self.modifier[self.identifier] = value


def _hidden(obj, kept, positions):
    hidden = rest_state.rest_copy(obj, kept)
    # Of the original object: its own mesh, without shape keys and modifiers.
    mesh = bpy.data.meshes.new_from_object(obj, preserve_all_data_layers=True)
    mesh.name = hidden.name = f".ltmd rest {obj.name}"
    hidden.data = mesh
    mesh.vertices.foreach_set("co", np.asarray(positions, np.float32).ravel())
    mesh.materials.clear()
    hidden.ltmd.source = "NONE"
    hidden.ltmd.rest_object = None
    hidden[REST_KEY] = obj.name
    # Appending brings it into the scene, and into sight in the viewport.
    hidden.hide_render = hidden.hide_viewport = hidden.hide_select = True
    hidden.display_type = "BOUNDS"
    if not np.allclose(_shape(obj), np.eye(3), atol=1e-4):
        # The metric of the rendered object. Not for all, as a moving object would have its rest
        # state evaluated at every frame.
        hidden.constraints.new("COPY_TRANSFORMS").target = obj
    return hidden


def _discard(hidden):
    mesh = hidden.data
    bpy.data.objects.remove(hidden)
    if mesh.users == 0:
        bpy.data.meshes.remove(mesh)


def _shape(obj):
    """The symmetric matrix of an object's scale, 1 if it is uniform."""
    matrix = np.array(obj.matrix_world.to_3x3(), float)
    volume = abs(obj.matrix_world.to_3x3().determinant())
    return matrix.T @ matrix / volume ** (2 / 3) if volume > 0 else np.zeros((3, 3))


def _adaptive(obj):
    # Of the object in 4.5, of the modifier in 5.x.
    return getattr(getattr(obj, "cycles", None), "use_adaptive_subdivision", False) or any(
        m.type == "SUBSURF" and getattr(m, "use_adaptive_subdivision", False) for m in obj.modifiers
    )
