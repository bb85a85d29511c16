# SPDX-License-Identifier: GPL-3.0-or-later
"""The rest state of an object and its reading as arrays.

The rest mesh goes through the constructive modifiers the render uses, with the deforming ones left
out and the Basis shape pinned, on a copy of the object in a scene of its own. Shape keys and bones
act before a Subsurf, so anything stored on the base mesh would be subdivided differently from the
positions it is compared with.
"""

import itertools
from dataclasses import dataclass

import bpy
import numpy as np

from . import evaluate
from .nodes import GROUP_KEY

# Modifiers that move points and add none. Everything else stays in the rest state, so that its
# points are the points of the render.
DEFORMING = frozenset(
    {
        "ARMATURE", "CAST", "CLOTH", "COLLISION", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE",
        "DYNAMIC_PAINT", "EXPLODE", "FLUID", "HOOK", "LAPLACIANDEFORM", "LAPLACIANSMOOTH",
        "LATTICE", "LINEART", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE",
        "PARTICLE_INSTANCE", "PARTICLE_SYSTEM", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH",
        "SOFT_BODY", "SURFACE", "SURFACE_DEFORM", "VOLUME_DISPLACE", "WARP", "WAVE",
    }
)  # fmt: skip

# 2^n rest meshes are made for n Geometry Nodes modifiers, see candidates().
_MOST_NODES = 3


class RestError(Exception):
    """No rest state; str() says why."""


@dataclass(frozen=True)
class Spec:
    """Which rest state: mode is "basis", "frame" or "object"."""

    mode: str = "basis"
    frame: int = 0
    object: str = ""

    @classmethod
    def parse(cls, text):
        """From `basis`, `frame:N` or `object:NAME`; raises ValueError."""
        head, _, rest = text.partition(":")
        if text == "basis":
            return cls()
        if head == "frame" and rest:
            try:
                return cls("frame", frame=int(rest))
            except ValueError:
                pass
        if head == "object" and rest:
            return cls("object", object=rest)
        raise ValueError(f"a rest state is basis, frame:N or object:NAME, not {text!r}")

    def __str__(self):
        return {"basis": "basis", "frame": f"frame:{self.frame}"}.get(
            self.mode, f"object:{self.object}"
        )


@dataclass
class MeshArrays:
    """An evaluated mesh as arrays; uv is None without the map."""

    positions: np.ndarray
    corner_vert: np.ndarray
    triangles: np.ndarray
    uv: np.ndarray | None
    uv_map: str
    kept: tuple = ()


def read_positions(mesh):
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    if len(positions):
        mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
    return positions


def read_corner_vert(mesh):
    corner_vert = np.empty(len(mesh.loops), np.int32)
    if len(corner_vert):
        mesh.attributes[".corner_vert"].data.foreach_get("value", corner_vert)
    return corner_vert


def read_uv(mesh, name):
    """The UV map as float32[corners, 2], or None if the mesh has none of this name."""
    layer = mesh.uv_layers.get(name)
    if layer is None:
        return None
    uv = np.empty((len(mesh.loops), 2), np.float32)
    layer.uv.foreach_get("vector", uv.ravel())
    return uv


def default_uv_map(mesh):
    """The name of the map active for render, or ""."""
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), "")


def read_mesh(mesh, uv_map):
    """Everything of an evaluated mesh, its triangles cut as Cycles cuts them."""
    uv_map = uv_map or default_uv_map(mesh)
    triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("loops", triangles.ravel())
    return MeshArrays(
        read_positions(mesh),
        read_corner_vert(mesh),
        triangles,
        read_uv(mesh, uv_map) if uv_map else None,
        uv_map,
    )


def candidates(scene, requests):
    """The rest meshes of objects, for each a list of MeshArrays, the likeliest first.

    requests: {key: (object, Spec, uv map)}. Whether a Geometry Nodes modifier makes points or only
    moves them cannot be read off it: every choice of the ones that stay is evaluated, the fewest
    first, and pick() takes the first one that has the points of the render.
    """
    copies = []
    work = bpy.data.scenes.new(".ltmd rest")
    try:
        _like(work, scene)
        for key, (obj, spec, uv_map) in requests.items():
            for kept in choices(obj):
                copy = rest_copy(obj, kept, _shape(spec))
                copies.append((key, kept, uv_map, _link(work, copy)))
            if spec.mode == "object":
                # A rest object whose modifiers are its own, or applied.
                shape = bpy.data.objects[spec.object]
                copies.append((key, (), uv_map, _link(work, shape.copy())))
        found = {key: [] for key in requests}

        def read(_frame, objects):
            for key, kept, uv_map, copy in copies:
                evaluated = objects[copy.session_uid]
                if evaluated is None:
                    raise RestError(f'The rest state of "{requests[key][0].name}" is not evaluated')
                arrays = read_mesh(evaluated.data, uv_map)
                arrays.kept = kept
                if requests[key][1].mode == "object":
                    # The render looks up with the UVs of the baked object.
                    arrays.uv, arrays.uv_map = None, ""
                found[key].append(arrays)

        evaluation = evaluate.Evaluation(
            work,
            work.view_layers[0],
            [copy.session_uid for *_, copy in copies],
            [scene.frame_current],
            read,
        )
        evaluate.run(evaluation)
        if evaluation.error is not None:
            raise evaluation.error
        return found
    finally:
        for *_, copy in copies:
            bpy.data.objects.remove(copy)
        bpy.data.scenes.remove(work)


def pick(name, choices, mesh):
    """The rest mesh among `choices` that has the topology of the evaluated `mesh`."""
    corner_vert = read_corner_vert(mesh)
    vertices = len(mesh.vertices)
    for arrays in choices:
        if len(arrays.positions) == vertices and np.array_equal(arrays.corner_vert, corner_vert):
            return arrays
    counts = [len(arrays.positions) for arrays in choices]
    if vertices in counts:
        raise RestError(
            f'"{name}" and its rest state have {vertices} vertices each, but different faces'
        )
    raise RestError(
        f'"{name}" has {vertices} vertices in the render, its rest state has {counts[0]}: '
        "they must be the same points"
    )


def _like(work, scene):
    """The settings of the scene that decide about modifiers."""
    work.frame_current = scene.frame_current
    for name in ("use_simplify", "simplify_subdivision_render", "simplify_child_particles_render"):
        setattr(work.render, name, getattr(scene.render, name))


def choices(obj):
    """The names of the Geometry Nodes modifiers that may stay in the rest state, each choice."""
    nodes = [
        modifier.name
        for modifier in obj.modifiers
        if modifier.type == "NODES" and modifier.show_render and not is_ours(modifier)
    ]
    if len(nodes) > _MOST_NODES:
        return [(), tuple(nodes)]
    return [
        kept for count in range(len(nodes) + 1) for kept in itertools.combinations(nodes, count)
    ]


def is_ours(modifier):
    """Is it one of LTMD's own, which only store numbers?"""
    group = getattr(modifier, "node_group", None)
    return group is not None and GROUP_KEY in group


def _shape(spec):
    """The object whose mesh is the rest state, or None."""
    if spec.mode != "object":
        return None
    shape = bpy.data.objects.get(spec.object)
    if shape is None or shape.type != "MESH":
        raise RestError(f'The rest object "{spec.object}" is not a mesh object of this file')
    return shape


def rest_copy(obj, kept, shape=None):
    """A copy of the object, not in any scene, with only the modifiers that make geometry.

    kept: the Geometry Nodes modifiers that stay; shape: another object whose mesh it gets.
    """
    copy = obj.copy()
    if copy.override_library is not None:
        copy.make_local(clear_liboverride=True)
    copy.animation_data_clear()
    if shape is not None:
        copy.data = shape.data
    # Basis only: without the pin the keys act before every modifier.
    copy.active_shape_key_index = 0
    copy.show_only_shape_key = True
    world = obj.matrix_world.copy()
    copy.parent = None
    copy.constraints.clear()
    copy.matrix_world = world
    for modifier in list(copy.modifiers):
        if modifier.type in DEFORMING or (modifier.type == "NODES" and modifier.name not in kept):
            copy.modifiers.remove(modifier)
    return copy


def _link(work, copy):
    copy.hide_render = False
    copy.hide_viewport = False
    work.collection.objects.link(copy)
    return copy
