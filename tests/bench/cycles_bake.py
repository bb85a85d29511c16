# SPDX-License-Identifier: Apache-2.0
"""Run by a Python with bpy: the time of Cycles' emission bake at one sample. SIZE"""

import os
import sys
import time

import bpy

size = int(sys.argv[1])
bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, app_template="")
bpy.ops.mesh.primitive_grid_add(x_subdivisions=158, y_subdivisions=158)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.cycles.use_denoising = False
scene.cycles.use_adaptive_sampling = False
scene.render.bake.margin = 16
material = bpy.data.materials.new("bake")
material.use_nodes = True
nodes = material.node_tree.nodes
nodes.clear()
emission = nodes.new("ShaderNodeEmission")
output = nodes.new("ShaderNodeOutputMaterial")
material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
image = nodes.new("ShaderNodeTexImage")
image.image = bpy.data.images.new("bake", size, size, float_buffer=True)
nodes.active = image
bpy.context.object.data.materials.append(material)
# The first bake pays for loading kernels.
start = None
for _ in range(2):
    start = time.perf_counter()
    bpy.ops.object.bake(type="EMIT")
print("seconds:", time.perf_counter() - start, flush=True)
os._exit(0)
