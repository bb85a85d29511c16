# SPDX-License-Identifier: Apache-2.0
"""scene.py ADDON_FOLDER OUT.blend: a shape that stretches, set up; by a Python that has bpy.

Beside it shown.blend, the picture of the manual: a preset, and the tension in false colour.
"""

import os
import sys

import bpy

sys.path.insert(0, sys.argv[1])
import blender_addon  # noqa: E402
from blender_addon import nodes  # noqa: E402
from blender_addon.nodes import texture_tension  # noqa: E402

bpy.utils.expose_bundled_modules()
bpy.ops.wm.read_factory_settings(use_empty=False)
blender_addon.register()
bpy.data.objects.remove(bpy.data.objects["Cube"])
bpy.ops.mesh.primitive_monkey_add()
obj = bpy.context.object
modifier = obj.modifiers.new("Subdivision", "SUBSURF")
modifier.levels = modifier.render_levels = 2
obj.shape_key_add(name="Basis")
key = obj.shape_key_add(name="Stretched")
for point in key.data:
    point.co = (point.co.x * 1.5, point.co.y, point.co.z * 0.8 + 0.3 * point.co.x)
for frame, value in ((1, 0.0), (20, 1.0)):
    key.value = value
    key.keyframe_insert("value", frame=frame)
bpy.ops.ltmd.setup(object_name=obj.name)
# A Blender without OSL cannot compile it when the bake turns the material to the images.
nodes.ensure(texture_tension).use_fake_user = True
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[2])
bpy.ops.ltmd.setup(object_name=obj.name, source="ATTRIBUTE")
bpy.ops.ltmd.preset(object_name=obj.name, preset="BRUSHED_GOLD")
bpy.ops.ltmd.show_tension(object_name=obj.name, mode="MAGNITUDE", range=1.5)
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.dirname(sys.argv[2]), "shown.blend"))
sys.stdout.flush()
os._exit(0)
