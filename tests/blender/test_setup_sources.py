# SPDX-License-Identifier: Apache-2.0
"""Live tension and the same tension baked to a texture give the same picture."""

import numpy as np
import pytest
from blender_process import run

SCENE = """
from math import radians
from mathutils import Matrix
cycles(64, 64, samples=4)
camera((3, -5, 4), ortho_scale=6)
for place in ((4, -2, 5), (-4, -5, 3)):
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "AREA"))
    light.data.energy, light.data.size, light.location = 400, 2, place
    light.rotation_euler = (-light.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(light)
c = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
f = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
# Six islands far apart; every second one mirrored. Parallelograms: the tension is constant on each.
corners = np.array(((.05, .05), (.25, .08), (.28, .4), (.08, .37)))
uvs = []
for k in range(6):
    island = corners * (1 if k % 2 else -1, 1) + (0 if k % 2 else .33, 0)
    uvs += [tuple(p) for p in island + (k % 3 / 3, k // 3 / 2)]
obj = mesh_object("Box", c, f, uvs)
obj.shape_key_add(name="Basis")
key = obj.shape_key_add(name="Deformed")
A = np.array([[1.5, .4, 0], [0, .7, .3], [.2, 0, 1.1]])
for point in key.data:
    point.co = A @ np.array(point.co)
key.value = 1
if ARGUMENTS["matrix"]:
    obj.matrix_world = Matrix(ARGUMENTS["matrix"])
if ARGUMENTS["inside"]:
    obj.data.flip_normals()
material = bpy.data.materials.new("Metal")
material.use_nodes = True
obj.data.materials.append(material)
bpy.ops.ltmd.setup(object_name="Box")
from blender_addon import surface
lobe = surface.lobe(material)
lobe.inputs["Stretch"].default_value = .4
lobe.inputs["Rotation"].default_value = .5
lobe.inputs["Shear"].default_value = .3
lobe.inputs["Roughness"].default_value = .55
output = material.node_tree.get_output_node("CYCLES")
material.node_tree.links.new(lobe.outputs[0], output.inputs[0])
live = render()[..., :3]
lobe.inputs["Strength"].default_value = 0
rest = render()[..., :3]
lobe.inputs["Strength"].default_value = 1
bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS["folder"] + "/scene.blend")
bpy.ops.ltmd.bake(frames="1", size=256, directory=ARGUMENTS["folder"])
assert obj.ltmd.source == "TEXTURE", obj.ltmd.source
texture = render()[..., :3]
report(live=live, texture=texture, rest=rest)
"""


@pytest.mark.parametrize(
    ("matrix", "inside"),
    [
        (None, False),
        (None, True),
        ([[-1.3, 0, 0, 0], [0, 1.1, 0, 0], [0, 0.2, 0.8, 0], [0, 0, 0, 1]], False),
    ],
    ids=["plain", "back faces", "mirrored and sheared object"],
)
def test_live_and_texture_agree(tmp_path, matrix, inside):
    result = run(SCENE, arguments={"folder": str(tmp_path), "matrix": matrix, "inside": inside})
    live, texture, rest = (np.array(result[k]) for k in ("live", "texture", "rest"))
    print(f"largest difference {np.abs(live - texture).max():.1e} at a maximum of {live.max():.2f}")
    scale = live.mean()
    assert np.abs(live - rest).mean() > 0.1 * scale  # the deformation shows
    assert np.abs(live - texture).max() < 1e-4 * live.max(), np.abs(live - texture).max()
