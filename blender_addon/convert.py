# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator Convert Material to LTMD."""

import bpy
from bpy.props import EnumProperty

from . import drive, setup, surface

METHODS = (
    (
        drive.METHOD,
        "Keep the Material",
        "Its own nodes stay; roughness, anisotropy and tangent of its Principled, Glossy and "
        "Metallic BSDFs follow the deformation",
    ),
    (
        surface.METHOD,
        "Replace the Reflection",
        "An LTMD group reflects in Cycles: for longer or shorter tails, and for highlights drawn "
        "out more than 10 : 1. Subsurface, coat, sheen and transmission are left out",
    ),
)


class LTMD_OT_convert_material(setup.SettingUp, bpy.types.Operator):
    """Let the materials of the selected objects follow the deformation"""

    bl_idname = "ltmd.convert_material"
    bl_label = "Convert Material to LTMD"
    bl_options = {"REGISTER", "UNDO"}

    method: EnumProperty(name="Method", description="What becomes of the material", items=METHODS)

    def work(self, obj):
        return setup.set_up(obj, osl=self.osl(bpy.context), method=self.method)


def register():
    bpy.utils.register_class(LTMD_OT_convert_material)


def unregister():
    bpy.utils.unregister_class(LTMD_OT_convert_material)
