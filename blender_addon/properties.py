# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings kept in the file: Object.ltmd, Material.ltmd, Scene.ltmd."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import false_colour, presets, surface
from .writable import is_writable

OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}

SOURCES = (
    ("NONE", "None", "LTMD is not set up on this object"),
    ("LIVE", "Live", "Measured while rendering, from the rest state and the deformed surface"),
    ("ATTRIBUTE", "Attribute", "Measured by a modifier at every frame, smooth, along the UV map"),
    ("TENSOR", "Tensor", "Measured by a modifier at every frame, smooth, without a UV map"),
    ("TEXTURE", "Texture", "Read from the baked images, one per frame"),
)

REST_MODES = (
    ("BASIS", "Basis", "The mesh without shape keys, armatures and other deformers"),
    ("FRAME", "Frame", "The object as it is at one frame"),
    ("OBJECT", "Object", "The surface of another object with the same topology"),
)

PASS_ITEMS = (
    ("TENSION", "Tension", "The deformation itself: what the LTMD materials read", 1),
    ("STRETCH", "Stretch", "Largest and smallest stretch, and the area; for masks", 2),
    ("WRINKLE", "Wrinkle", "Stretch along U and V, and the shear angle; for wrinkle maps", 4),
    ("ALPHA2", "Alpha²", "The deformed highlight as a matrix, for other renderers", 8),
    ("ROUGHNESS", "Roughness", "The deformed highlight as two roughnesses and a direction", 16),
)


METALS = (
    ("COLOUR", "By Colour", "Chosen by its colour straight on and near the outline", 0),
    ("VALUES", "By Values", "Index of refraction and extinction, as metals are measured", 1),
    *(
        (key, preset.label, "Measured index of refraction and extinction", number)
        for number, (key, preset) in enumerate(presets.METAL.items(), 2)
    ),
)

MODES = (
    ("ALL", "All Highlights", "Add up the highlights that shape the tail", 0),
    ("RANDOM", "One at Random", "Take one at random: the same picture with more noise", 1),
    ("REFERENCE", "Reference", "Random microfacets: exact and very noisy, for comparisons", 2),
)

VIEWS = (
    ("MAGNITUDE", "Magnitude", "The largest and the smallest stretch of any direction", 0),
    ("AREA", "Area", "How much the area has grown or shrunk", 1),
    ("DIRECTIONS", "Directions", "Strokes along the direction that is stretched most", 2),
)


def _numbered(name, description, items, sockets):
    """Words for an Int socket; sockets(material): those that follow the choice."""

    def get(self):
        found = next(iter(sockets(self.id_data)), None)
        return min(max(found.default_value, 0), len(items) - 1) if found else 0

    def choose(self, number):
        if is_writable(self.id_data):
            for socket in sockets(self.id_data):
                socket.default_value = number

    return EnumProperty(
        name=name, description=description, items=items, get=get, set=choose, options=set()
    )


def _of_lobe(name):
    def sockets(material):
        node = surface.lobe(material)
        return [node.inputs[name]] if node and name in node.inputs else []

    return sockets


def _of_views(name):
    def sockets(material):
        return [view.inputs[name] for view in false_colour.views(material)]

    return sockets


def _slider(name, description, sockets, low, high):
    """One value for the same socket of several nodes."""

    def get(self):
        found = next(iter(sockets(self.id_data)), None)
        return found.default_value if found else low

    def choose(self, value):
        if is_writable(self.id_data):
            for socket in sockets(self.id_data):
                socket.default_value = value

    return FloatProperty(
        name=name, description=description, min=low, max=high, get=get, set=choose, options=set()
    )


def _present_metal(self):
    node = surface.lobe(self.id_data)
    if node is None or "Conductor Type" not in node.inputs:
        return 0
    if node.inputs["Conductor Type"].default_value == 0:
        return 0
    for number, preset in enumerate(presets.METAL.values(), 2):
        pairs = [(node.inputs[name], preset.sockets[name]) for name in ("IOR", "Extinction")]
        if all(
            abs(found - wanted) < 1e-5
            for socket, values in pairs
            for found, wanted in zip(socket.default_value, values, strict=True)
        ):
            return number
    return 1


def _choose_metal(self, number):
    node = surface.lobe(self.id_data)
    if node is None or "Conductor Type" not in node.inputs or not is_writable(self.id_data):
        return
    key = METALS[number][0]
    values = presets.METAL[key].sockets if number > 1 else {"Conductor Type": number}
    for name, value in values.items():
        node.inputs[name].default_value = value


def _is_mesh(_self, obj):
    return obj.type == "MESH"


class LtmdObjectSettings(bpy.types.PropertyGroup):
    source: EnumProperty(
        name="Source",
        description="Where the highlights get the deformation from",
        items=SOURCES,
        default="NONE",
        override=OVERRIDABLE,
    )
    rest_mode: EnumProperty(
        name="Rest State",
        description="The shape in which the material looks as designed; stretch is counted from it",
        items=REST_MODES,
        default="BASIS",
        override=OVERRIDABLE,
    )
    rest_frame: IntProperty(
        name="Rest Frame",
        description="The frame whose shape is the rest state",
        default=1,
        override=OVERRIDABLE,
    )
    rest_object: PointerProperty(
        name="Rest Object",
        description="The mesh object whose surface is the rest state; same topology as this one",
        type=bpy.types.Object,
        poll=_is_mesh,
        override=OVERRIDABLE,
    )
    uv_map: StringProperty(
        name="UV Map",
        description="The UV map to bake into; empty: the map active for render",
        default="",
        override=OVERRIDABLE,
    )
    passes: EnumProperty(
        name="Passes",
        description="What to bake, each into its own files",
        items=PASS_ITEMS,
        options={"ENUM_FLAG"},
        default={"TENSION"},
        override=OVERRIDABLE,
    )
    size: IntProperty(
        name="Size",
        description="Width and height of the baked images in pixels",
        default=1024,
        min=16,
        max=16384,
        subtype="PIXEL",
        override=OVERRIDABLE,
    )
    margin: IntProperty(
        name="Margin",
        description="How far values continue beyond the edge of a UV island, in pixels",
        default=16,
        min=0,
        max=64,
        subtype="PIXEL",
        override=OVERRIDABLE,
    )
    frame_start: IntProperty(
        name="First Frame",
        description="First frame to bake",
        default=1,
        min=0,
        override=OVERRIDABLE,
    )
    frame_end: IntProperty(
        name="Last Frame",
        description="Last frame to bake",
        default=250,
        min=0,
        override=OVERRIDABLE,
    )
    directory: StringProperty(
        name="Output Folder",
        description="Folder for the baked images; // is the folder of the saved file",
        default="//ltmd/",
        subtype="DIR_PATH",
        # Else the field is red until the first bake has made the folder.
        options={"OUTPUT_PATH", "PATH_SUPPORTS_BLEND_RELATIVE"},
        override=OVERRIDABLE,
    )
    slot_added: BoolProperty(
        name="Slot Made by Set-Up",
        description="The material slot was made because the object had none",
        default=False,
        options={"HIDDEN"},
    )


class LtmdMaterialSettings(bpy.types.PropertyGroup):
    # Written by set-up and read by remove; not shown.
    set_up: IntProperty(
        name="Set-Up Version",
        description="Version of the LTMD set-up in this material; 0: none",
        default=0,
        options={"HIDDEN"},
    )
    record: StringProperty(
        name="Set-Up Record",
        description="What the set-up added and changed, so that removing it can restore the rest",
        default="",
        options={"HIDDEN"},
    )
    created: BoolProperty(
        name="Made by Set-Up",
        description="The material was made because the object had none",
        default=False,
        options={"HIDDEN"},
    )
    # Not stored: words for numbers in the node tree.
    metal: EnumProperty(
        name="Metal",
        description="Which metal an LTMD Conductor is",
        items=METALS,
        get=_present_metal,
        set=_choose_metal,
        options=set(),
    )
    mode: _numbered(
        "Mode", "How the highlights that shape the tail are rendered", MODES, _of_lobe("Mode")
    )
    view: _numbered("View", "What the false colours show", VIEWS, _of_views("Mode"))
    view_range: _slider(
        "Full Colour At",
        "Factor of stretch (or of squeeze) that is shown in full colour",
        _of_views("Range"),
        1.001,
        100.0,
    )
    view_density: _slider(
        "Strokes",
        "How many strokes fit along the longest side of the object",
        _of_views("Density"),
        1.0,
        1000.0,
    )


CLASSES = (LtmdObjectSettings, LtmdMaterialSettings)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.ltmd = PointerProperty(
        name="LTMD", type=LtmdObjectSettings, override=OVERRIDABLE
    )
    bpy.types.Material.ltmd = PointerProperty(
        name="LTMD", type=LtmdMaterialSettings, override=OVERRIDABLE
    )


def unregister():
    del bpy.types.Material.ltmd
    del bpy.types.Object.ltmd
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
