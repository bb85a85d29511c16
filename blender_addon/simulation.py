# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes frames depend on more than their number: simulations, drivers, unkeyed edits."""

import os
from dataclasses import dataclass

import bpy


@dataclass(frozen=True)
class Cache:
    """A simulation the shape of an object depends on."""

    object: str
    modifier: str
    kind: str
    start: int
    baked: bool


def problems(obj, scene, order):
    """Sentences about simulations that would differ from the render's for these frames in order.

    A simulation that is not baked is right only when it is stepped through from its start: a jump
    to a frame gives another cloth than the steps to it, without a word.
    """
    stepped = bool(order) and order == list(range(order[0], order[-1] + 1))
    found = []
    for cache in unbaked(obj, scene):
        if stepped and order[0] <= cache.start:
            continue
        where = f' (of "{cache.object}")' if cache.object != obj.name else ""
        found.append(
            f'"{obj.name}": the {cache.kind} "{cache.modifier}"{where} is not baked. Bake its '
            f"cache, or bake every frame from its start, {cache.start}, on"
        )
    return found


def unbaked(obj, scene=None):
    """The simulations of an object, and of what shapes it, that are not baked."""
    return [cache for cache in _caches(obj, scene or bpy.context.scene, set()) if not cache.baked]


def _caches(obj, scene, seen):
    if obj.session_uid in seen:
        return
    seen.add(obj.session_uid)
    uses_particles = any(
        m.type in {"EXPLODE", "PARTICLE_INSTANCE"} and m.show_render for m in obj.modifiers
    )
    for modifier in obj.modifiers:
        if not modifier.show_render:
            continue
        yield from _modifier_caches(obj, modifier, scene, uses_particles)
        for other in _objects_of(modifier):
            yield from _caches(other, scene, seen)
            if modifier.type == "PARTICLE_INSTANCE":
                for system in other.particle_systems:
                    yield _point_cache(other, system.name, "particle system", system.point_cache)


def _modifier_caches(obj, modifier, scene, uses_particles):
    if modifier.type in {"CLOTH", "SOFT_BODY"}:
        kind = "cloth simulation" if modifier.type == "CLOTH" else "soft body simulation"
        yield _point_cache(obj, modifier.name, kind, modifier.point_cache)
    elif modifier.type == "PARTICLE_SYSTEM" and uses_particles:
        cache = modifier.particle_system.point_cache
        yield _point_cache(obj, modifier.name, "particle system", cache)
    elif modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings is not None:
        for surface in modifier.canvas_settings.canvas_surfaces:
            if surface.is_active and surface.surface_type in {"DISPLACE", "WAVE"}:
                yield _point_cache(obj, modifier.name, "dynamic paint", surface.point_cache)
    elif modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
        domain = modifier.domain_settings
        yield Cache(
            obj.name,
            modifier.name,
            "fluid simulation",
            domain.cache_frame_start,
            domain.has_cache_baked_mesh or domain.has_cache_baked_any,
        )
    elif modifier.type == "NODES":
        for bake in modifier.bakes:
            if bake.node is not None and bake.node.bl_idname == "GeometryNodeSimulationOutput":
                yield Cache(
                    obj.name,
                    modifier.name,
                    "simulation zone",
                    _zone_start(bake, scene),
                    _zone_is_on_disk(modifier, bake),
                )


def _point_cache(obj, modifier, kind, cache):
    baked = cache.is_baked or cache.use_external
    return Cache(obj.name, modifier, kind, cache.frame_start, baked)


def _zone_start(bake, scene):
    if bake.use_custom_simulation_frame_range:
        return bake.frame_start
    if scene.use_custom_simulation_range:
        return scene.simulation_frame_start
    return scene.frame_start


def _zone_is_on_disk(modifier, bake):
    # Python cannot ask whether a zone is baked; only a bake on disk can be seen.
    base = bake.directory if bake.use_custom_path else modifier.bake_directory
    if not base:
        return False
    folder = bpy.path.abspath(base)
    if not bake.use_custom_path:
        folder = os.path.join(folder, str(bake.bake_id))
    return os.path.isdir(os.path.join(folder, "meta"))


def _objects_of(modifier):
    for prop in modifier.bl_rna.properties:
        if prop.type == "POINTER":
            value = getattr(modifier, prop.identifier, None)
            if isinstance(value, bpy.types.Object):
                yield value


# --- drivers -------------------------------------------------------------------------------------


def frozen_driver():
    """A Python driver that Blender refused to run, as words, or None.

    Blender runs harmless expressions in any file; only an evaluation shows which it refuses.
    """
    message = bpy.app.autoexec_fail_message
    if not (bpy.app.autoexec_fail or bpy.app.autoexec_fail_quiet) or "Driver" not in message:
        return None
    # The message is cut to a fixed length.
    expression = message.removeprefix("Driver ").strip("'")
    return next((words for words in python_drivers() if expression in words), message)


def python_drivers():
    found = []
    for collection in (
        bpy.data.objects,
        bpy.data.shape_keys,
        bpy.data.meshes,
        bpy.data.armatures,
        bpy.data.lattices,
        bpy.data.curves,
        bpy.data.node_groups,
        bpy.data.scenes,
    ):
        for data in collection:
            animation = getattr(data, "animation_data", None)
            for curve in animation.drivers if animation is not None else ():
                driver = curve.driver
                if driver.type == "SCRIPTED" and not driver.is_simple_expression:
                    found.append(f'"{data.name}" {curve.data_path} = {driver.expression}')
    return found


# --- unkeyed edits -------------------------------------------------------------------------------


def unkeyed_edits(obj, scene):
    """Animated values of the object, its keys and its armatures that differ from their curves."""
    if obj.hide_viewport:
        # Not evaluated now: its values are from some other frame.
        return []
    owners = [obj, obj.data]
    if obj.data is not None and getattr(obj.data, "shape_keys", None) is not None:
        owners.append(obj.data.shape_keys)
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.object is not None:
            owners.append(modifier.object)
    if obj.parent is not None:
        owners.append(obj.parent)
    edits = (
        f"{owner.name} {curve.data_path}"
        for owner in dict.fromkeys(owners)
        for curve in _curves(owner)
        if _differs(owner, curve, scene)
    )
    return list(dict.fromkeys(edits))


def _curves(owner):
    animation = getattr(owner, "animation_data", None)
    # With NLA tracks the value is not the curve's.
    if animation is None or animation.action is None or len(animation.nla_tracks):
        return
    slot = animation.action_slot
    for layer in animation.action.layers:
        for strip in layer.strips:
            channels = strip.channelbag(slot) if slot is not None else None
            if channels is not None:
                yield from channels.fcurves


def _differs(owner, curve, scene):
    if curve.mute:
        return False
    try:
        value = owner.path_resolve(curve.data_path)
        value = value[curve.array_index] if hasattr(value, "__len__") else value
        wanted = curve.evaluate(scene.frame_current + scene.frame_subframe)
        if isinstance(value, (bool, int)):
            return int(value) != int(wanted)
        return abs(float(value) - wanted) > 1e-4 * max(1.0, abs(wanted))
    except (ValueError, TypeError, IndexError):
        return False
