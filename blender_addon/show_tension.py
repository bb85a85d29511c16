# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator Show Tension."""

import bpy
from bpy.props import EnumProperty, FloatProperty

from . import device, false_colour, nodes, setup, source
from .properties import VIEWS
from .writable import NODES_REFUSAL, is_local


class LTMD_OT_show_tension(setup.OnObjects, bpy.types.Operator):
    """Show how the selected objects are deformed, in false colour, or their materials again"""

    bl_idname = "ltmd.show_tension"
    bl_label = "Show Tension"
    bl_options = {"REGISTER", "UNDO"}

    show: EnumProperty(
        name="Show",
        items=(
            ("TOGGLE", "Toggle", "The tension, or the material if the tension is shown"),
            ("TENSION", "Tension", "The deformation in false colour"),
            ("MATERIAL", "Material", "The material as it was"),
        ),
        default="TOGGLE",
        options={"SKIP_SAVE"},
    )
    mode: EnumProperty(
        name="View",
        description="What the colours show",
        items=VIEWS,
        default="MAGNITUDE",
    )
    range: FloatProperty(
        name="Full Colour At",
        description="Factor of stretch (or of squeeze) that is shown in full colour",
        default=2.0,
        min=1.001,
        max=100.0,
    )

    def work(self, obj):
        chosen = source.materials(obj)
        if not chosen:
            raise source.SourceError(f"{obj.name} is not set up: press Set Up LTMD first")
        for material in chosen:
            if not is_local(material):
                raise source.SourceError(f"{material.name}: {NODES_REFUSAL}")
        for material in chosen:
            if self.wanted:
                number = next(item[3] for item in VIEWS if item[0] == self.mode)
                false_colour.show(material, number, self.range, device.uses_osl(bpy.context))
            else:
                false_colour.hide(material)
        if not self.wanted:
            nodes.remove_unused()
        return []

    def execute(self, context):
        if self.show == "TOGGLE":
            try:
                objects = setup.target_objects(context, self.object_name)
            except source.SourceError:
                objects = []
            # Objects may share a material: all go one way.
            self.wanted = not any(
                false_colour.is_shown(m) for obj in objects for m in source.materials(obj)
            )
        else:
            self.wanted = self.show == "TENSION"
        return super().execute(context)


def register():
    bpy.utils.register_class(LTMD_OT_show_tension)


def unregister():
    bpy.utils.unregister_class(LTMD_OT_show_tension)
