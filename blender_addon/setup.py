# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators Set Up LTMD and Remove LTMD Set-Up."""

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty

from . import device, drive, false_colour, modifier, nodes, source, surface
from .nodes import glossy
from .properties import SOURCES
from .writable import NODES_REFUSAL, REFUSAL, is_local, is_writable


def target_objects(context, name):
    """The mesh objects an operator works on: the one named, or selected and active ones."""
    if name:
        obj = bpy.data.objects.get(name)
        if obj is None:
            raise source.SourceError(f"There is no object named {name}")
        if obj.type != "MESH":
            raise source.SourceError(f"{name} is not a mesh")
        return [obj]
    chosen = list(context.selected_objects)
    if context.object and context.object not in chosen:
        chosen.append(context.object)
    meshes = [obj for obj in chosen if obj.type == "MESH"]
    if not meshes:
        raise source.SourceError("Select a mesh object first")
    return meshes


def set_up(obj, kind="PRESENT", osl=True, method=None, together=()):
    """Set up one object; return sentences for the user. Raises SourceError.

    kind: the source; PRESENT keeps the one the object has; a new one gets live tension, without
    osl the tensor of a modifier.
    osl: take the groups in Open Shading Language, or their twins of stock nodes.
    method: how materials follow, of drive or surface; None leaves those that are set up as they
    are, and replaces the others' reflection.
    together: the objects that get the same source, and so keep the materials they share.
    """
    if not is_writable(obj):
        raise source.SourceError(f"{obj.name}: {REFUSAL}")
    if kind == "PRESENT":
        first = "LIVE" if osl else "TENSOR"  # what stock nodes can read, without a UV map
        kind = first if obj.ltmd.source == "NONE" else obj.ltmd.source
    textures = kind == "TEXTURE"
    _compile("LIVE" if textures else kind, osl, method)
    made = None
    if not any(slot.material for slot in obj.material_slots):
        made = _new_material(obj)
    try:
        told = source.measure(obj, "LIVE" if textures else kind)
    except source.SourceError:
        if made:
            _discard(obj, made)
        raise
    refused, done = [], 0
    for material in list(dict.fromkeys(s.material for s in obj.material_slots if s.material)):
        if not is_local(material):
            if method:
                refused.append(f"{material.name}: {NODES_REFUSAL}")
                continue
            # The node tree of linked data cannot be changed; a slot of the object can.
            linked, material = material, source.own_copy(obj, material)
            told.append(f"{obj.name} has its own copy of the linked material {linked.name} now")
        try:
            had_source, sentences = _follow(material, method, osl)
        except source.SourceError as error:
            refused.append(str(error))
            continue
        told += sentences
        done += 1
        if not (textures and had_source):
            told += source.switch(obj, material, "LIVE" if textures else kind, together)
    if not done:
        if obj.ltmd.source == "NONE":
            _forget(obj)
        raise source.SourceError("; ".join(refused))
    obj.ltmd.source = kind
    if kind == "LIVE" and not osl:
        told.append(
            f"{obj.name}: live tension needs Open Shading Language and is shown at rest; choose "
            "Attribute or Tensor as source, or bake"
        )
    for material in source.materials(obj):
        device.match(material, osl)
        false_colour.refresh(material, osl)
    return told + refused


def _compile(kind, osl, method):
    """Make the groups, while nothing is changed yet. Raises SourceError or RuntimeError."""
    needed = [source.group_for(source.GROUPS[kind])]
    if osl and method != drive.METHOD:
        needed.append(glossy)
    try:
        for module in needed:
            nodes.ensure(module)
    except RuntimeError:
        nodes.remove_unused()
        raise


def _follow(material, method, osl):
    """Let the material follow by the method; (had it been set up before, sentences)."""
    present = drive.METHOD if drive.is_driven(material) else surface.METHOD
    add = drive.drive if (method or present) == drive.METHOD else surface.add
    if not surface.is_set_up(material):
        return False, add(material, osl)
    if surface.lobe(material) is None:
        # The user has deleted it: all is made anew.
        _restore(material)
        return False, add(material, osl)
    if method in (None, present):
        return True, []
    trial = material.copy()
    try:
        _restore(trial)
        add(trial, osl)  # a refusal comes before anything is changed
    except source.SourceError as error:
        raise source.SourceError(str(error).replace(trial.name, material.name)) from None
    finally:
        bpy.data.materials.remove(trial)
    false_colour.hide(material)
    return True, surface.exchange(material, lambda m: add(m, osl))


def _restore(material):
    """The user's own tree again."""
    false_colour.hide(material)
    source.clear(material)
    surface.remove(material)


def remove(obj):
    """Undo set_up(); return sentences for the user. Raises SourceError."""
    chosen = source.materials(obj)
    for material in chosen:
        if not is_local(material):
            raise source.SourceError(f"{material.name}: {NODES_REFUSAL}")
    told = []
    for material in chosen:
        created = material.ltmd.created
        _restore(material)
        for other in source.users(material):
            if other != obj:
                told.append(f"{material.name} is shared: also removed from {other.name}")
                if not source.materials(other):
                    _forget(other)
        if created:
            _discard(obj, material)
    _forget(obj)
    nodes.remove_unused()
    return told


def _forget(obj):
    obj.ltmd.source = "NONE"
    modifier.remove(obj)
    mesh = obj.data
    if is_writable(mesh):
        modifier.clear_stored(mesh)
    if is_writable(mesh) and not source.has_live_twin(obj):
        source.clear_rest(mesh)
    _remove_slot(obj)


def _remove_slot(obj):
    """Remove the slot that _new_material() has added, if it is empty again."""
    materials = obj.data.materials
    if obj.ltmd.slot_added:
        obj.ltmd.slot_added = False
        if is_writable(obj.data) and len(materials) and materials[-1] is None:
            materials.pop()


def _discard(obj, material):
    """Take the material that _new_material() has made away from the object."""
    for slot in obj.material_slots:
        if slot.material == material:
            slot.material = None
    if material.users == 0:
        bpy.data.materials.remove(material)
    _remove_slot(obj)


def _new_material(obj):
    material = bpy.data.materials.new(f"{obj.name} LTMD")
    if not material.use_nodes:
        material.use_nodes = True
    material.ltmd.created = True
    if len(obj.data.materials):  # the object's own list may be behind
        if not is_writable(obj.data):
            obj.material_slots[0].link = "OBJECT"
        obj.material_slots[0].material = material
    elif is_writable(obj.data):
        obj.data.materials.append(material)
        obj.ltmd.slot_added = True
    else:
        bpy.data.materials.remove(material)
        raise source.SourceError(f"{obj.name} has no material slot: {REFUSAL}")
    return material


class OnObjects:
    object_name: StringProperty(
        name="Object",
        description="Name of the mesh object; empty: the selected ones",
        default="",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        cls.poll_message_set("Works in object mode")
        return context.mode == "OBJECT"

    def execute(self, context):
        try:
            objects = target_objects(context, self.object_name)
        except source.SourceError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.objects = objects
        done = 0
        for obj in objects:
            try:
                for sentence in self.work(obj):
                    self.report({"INFO"}, sentence)
                done += 1
            except (source.SourceError, RuntimeError) as error:
                self.report({"WARNING" if len(objects) > 1 else "ERROR"}, str(error))
        if not done:
            return {"CANCELLED"}
        self.after(context, done)
        return {"FINISHED"}

    def after(self, context, done):
        """When all objects are done."""


class SettingUp(OnObjects):
    use_osl: BoolProperty(
        name="Cycles with Open Shading Language",
        description="Switch this scene to Cycles with Open Shading Language, if its device can. "
        "Without it stock nodes are used, which have no live tension",
        default=True,
    )

    def invoke(self, context, event):
        if self.osl(context) and not device.osl_on(context.scene):
            return context.window_manager.invoke_confirm(
                self,
                event,
                title=self.bl_label,
                message="This scene will render in Cycles with Open Shading Language",
                confirm_text="Set Up",
            )
        return self.execute(context)

    def osl(self, context):
        """Will the scene render with Open Shading Language?"""
        return device.has_osl(context) and (self.use_osl or device.osl_on(context.scene))

    def after(self, context, done):
        scene = context.scene
        if self.osl(context) and not device.osl_on(scene):
            scene.render.engine = "CYCLES"
            scene.cycles.shading_system = True
        good, sentence = device.osl_status(context)
        self.report({"INFO"} if good else {"WARNING"}, sentence)


class LTMD_OT_setup(SettingUp, bpy.types.Operator):
    """Make the highlights of the selected objects follow their deformation"""

    bl_idname = "ltmd.setup"
    bl_label = "Set Up LTMD"
    bl_options = {"REGISTER", "UNDO"}

    source: EnumProperty(
        name="Source",
        description="Where the highlights get the deformation from",
        items=(
            (
                "PRESENT",
                "Present",
                "As it is; on an object that is not set up what suits the device",
            ),
            *(item for item in SOURCES if item[0] in source.GROUPS),
        ),
        default="PRESENT",
        options={"SKIP_SAVE"},
    )

    def work(self, obj):
        # Each keeps its own source with PRESENT.
        together = () if self.source == "PRESENT" else self.objects
        return set_up(obj, self.source, self.osl(bpy.context), together=together)


class LTMD_OT_store_tension(OnObjects, bpy.types.Operator):
    """Keep the tension of this frame in the mesh, for export or a still; it is shown at every frame
    until Set Up LTMD is pressed again"""

    bl_idname = "ltmd.store_tension"
    bl_label = "Store Tension of This Frame"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, obj):
        return source.store_frame(obj)


class LTMD_OT_remove(OnObjects, bpy.types.Operator):
    """Take LTMD off the selected objects and restore their materials"""

    bl_idname = "ltmd.remove"
    bl_label = "Remove LTMD Set-Up"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, obj):
        if not is_writable(obj):
            raise source.SourceError(f"{obj.name}: {REFUSAL}")
        return remove(obj)


CLASSES = (LTMD_OT_setup, LTMD_OT_store_tension, LTMD_OT_remove)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
