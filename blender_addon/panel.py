# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel "LTMD": Properties editor (object and material) and the 3D view's sidebar."""

import textwrap

import bpy

from . import device, drive, false_colour, library, modifier, source, surface, versions
from .properties import SOURCES
from .writable import REFUSAL, is_writable


def sentence(layout, context, text, icon="NONE", alert=False):
    """A sentence broken to the width of the region."""
    column = layout.column(align=True)
    column.alert = alert
    column.scale_y = 0.8
    width = context.region.width if context.region else 300
    scale = context.preferences.system.ui_scale or 1.0  # 0 in background
    lines = textwrap.wrap(text, max(20, int((width - 60 * scale) / (6.5 * scale))))
    for index, line in enumerate(lines):
        column.label(text=line, icon=icon if index == 0 else ("BLANK1" if icon != "NONE" else icon))


def state(obj):
    """In words: what the object's highlights do now."""
    kind = obj.ltmd.source
    if kind == "NONE" or not source.materials(obj):
        return "Not set up: highlights ignore the deformation"
    if kind == "LIVE":
        return "Live: the deformation is measured while rendering"
    if kind == "TEXTURE":
        return "Texture: the deformation is read from the baked images"
    name = "Attribute" if kind == "ATTRIBUTE" else "Tensor"
    return f"{name}: a modifier measures every frame; smooth, the same throughout a motion blur"


def draw(layout, context):
    obj = context.object
    layout.use_property_split = True
    layout.use_property_decorate = False
    if obj is None or obj.type != "MESH":
        sentence(layout, context, "LTMD works on mesh objects")
        return

    good, words = device.osl_status(context)
    sentence(layout, context, words, icon="NONE" if good else "ERROR")
    sentence(layout, context, state(obj))
    words = source.limits(obj, context.scene.frame_current)
    if words:
        sentence(layout, context, words, icon="INFO")
    for material in source.materials(obj):
        words = device.mismatch(material, context)
        if words:
            sentence(layout, context, words, icon="ERROR")
            layout.operator("ltmd.setup", text="Update for This Device").object_name = ""
            break
    if not is_writable(obj):
        sentence(layout, context, REFUSAL, icon="ERROR")

    row = layout.row(align=True)
    row.operator("ltmd.setup", text="Set Up LTMD").object_name = ""
    if obj.ltmd.source != "NONE":
        row.operator("ltmd.remove", text="Remove").object_name = ""
        name = next(item[1] for item in SOURCES if item[0] == obj.ltmd.source)
        layout.operator_menu_enum("ltmd.setup", "source", text=f"Source: {name}")
    if modifier.find(obj) and obj.ltmd.source in modifier.STORED:
        layout.operator("ltmd.store_tension").object_name = ""
    layout.operator_menu_enum("ltmd.convert_material", "method")

    draw_older(layout, context)
    material = shown_material(obj)
    if material is not None:
        draw_material(layout, context, material)
        draw_tension(layout, context, material)


def draw_older(layout, context):
    """Groups that an older version of the extension made."""
    if versions.older_groups():
        words = "Some LTMD nodes of this file are of an older version and look as they did"
        sentence(layout, context, words, icon="INFO")
        layout.operator("ltmd.update_nodes")


def shown_material(obj):
    """The active material if it is set up, otherwise the first one that is."""
    found = source.materials(obj)
    active = obj.active_material
    return active if active in found else next(iter(found), None)


def sliders(column, node, names):
    """The inputs that no node feeds."""
    for name in names:
        socket = node.inputs.get(name)
        if socket is not None and not socket.is_linked:
            # The whole of "Height Response" does not fit beside its field.
            column.prop(socket, "default_value", text=name.removesuffix(" Response"))


def draw_material(layout, context, material):
    node = surface.lobe(material)
    if node is None:
        return
    header = layout.row()
    header.label(text=material.name, icon="MATERIAL")
    if material == context.object.active_material and not drive.is_driven(material):
        header.operator_menu_enum("ltmd.preset", "preset", text="Preset")
    settings = material.ltmd
    body = layout.column()
    body.enabled = is_writable(material)
    if "Conductor Type" in node.inputs:
        body.prop(settings, "metal")
        if settings.metal == "COLOUR":
            sliders(body.column(align=True), node, ("Base Color", "Edge Tint"))
        else:
            header, values = body.panel("LTMD_metal", default_closed=True)
            header.label(text="Measured Values")
            if values:
                sliders(values.column(align=True), node, ("IOR", "Extinction"))
    elif "Coat Tint" in node.inputs:
        sliders(body.column(align=True), node, ("Coat Tint", "IOR"))
    column = body.column(align=True)
    sliders(column, node, ("Roughness", "Tail"))
    column = body.column(align=True)
    sliders(column, node, ("Stretch", "Rotation", "Shear"))
    column = body.column(align=True)
    sliders(column, node, ("Strength", "Height Response"))
    words = drive.limits(material) if drive.is_driven(material) else surface.roughest(node)
    if words:
        sentence(layout, context, words, icon="INFO")
    header, body = layout.panel("LTMD_quality", default_closed=True)
    header.label(text="Quality")
    if body:
        body.enabled = is_writable(material)
        if "Mode" in node.inputs and not node.inputs["Mode"].is_linked:
            body.prop(settings, "mode")
        sliders(body.column(align=True), node, ("Lobes", "Preserve Energy", "Roughness Is Alpha"))


def draw_tension(layout, context, material):
    shown = false_colour.is_shown(material)
    row = layout.row()
    row.operator("ltmd.show_tension", depress=shown, icon="COLOR").object_name = ""
    if not shown:
        return
    view = false_colour.views(material)[0]
    layout.prop(material.ltmd, "view")
    column = layout.column(align=True)
    column.prop(material.ltmd, "view_range")
    if material.ltmd.view == "DIRECTIONS":
        column.prop(material.ltmd, "view_density")
    sentence(layout, context, false_colour.legend(view))


def draw_bake(layout, context):
    obj = context.object
    layout.use_property_split = True
    layout.use_property_decorate = False
    settings = obj.ltmd
    column = layout.column()
    column.enabled = is_writable(obj)
    column.prop(settings, "rest_mode")
    if settings.rest_mode == "FRAME":
        column.prop(settings, "rest_frame")
    elif settings.rest_mode == "OBJECT":
        column.prop(settings, "rest_object")
    column.prop_search(settings, "uv_map", obj.data, "uv_layers", icon="GROUP_UVS")
    pair = column.column(align=True)
    pair.prop(settings, "size")
    pair.prop(settings, "margin")
    pair = column.column(align=True)
    pair.prop(settings, "frame_start", text="Frames, First")
    pair.prop(settings, "frame_end", text="Last")
    column.prop(settings, "directory")
    column.column(align=True).prop(settings, "passes", expand=True)

    problem = library.problem()
    if problem:
        sentence(layout, context, problem, icon="ERROR")
    if settings.directory.startswith("//") and not bpy.data.filepath:
        sentence(layout, context, "Save the file first", icon="INFO")
    if not obj.data.uv_layers:
        sentence(layout, context, "Baking needs a UV map; live tension does not", icon="INFO")
    row = layout.row()
    row.enabled = not problem
    if hasattr(bpy.types, "LTMD_OT_bake"):
        row.operator("ltmd.bake")
        row.operator("ltmd.bake", text="Resume").resume = True


class _Main:
    bl_label = "LTMD"

    def draw(self, context):
        draw(self.layout, context)


class _Bake:
    bl_label = "Bake Tension"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context):
        draw_bake(self.layout, context)


class LTMD_PT_object(_Main, bpy.types.Panel):
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}


class LTMD_PT_object_bake(_Bake, bpy.types.Panel):
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_parent_id = "LTMD_PT_object"


class LTMD_PT_material(_Main, bpy.types.Panel):
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}


class LTMD_PT_view3d(_Main, bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "LTMD"


class LTMD_PT_view3d_bake(_Bake, bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "LTMD"
    bl_parent_id = "LTMD_PT_view3d"


CLASSES = (
    LTMD_PT_object,
    LTMD_PT_object_bake,
    LTMD_PT_material,
    LTMD_PT_view3d,
    LTMD_PT_view3d_bake,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
