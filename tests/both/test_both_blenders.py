# SPDX-License-Identifier: Apache-2.0
"""Blender 4.5 and 5.2 bake the same texels and render the same pictures."""

import bake_reference as reference
import numpy as np
import pytest
from blender_process import run

BLENDERS = ("4.5", "5.2")
SEEDS = 12
SAMPLES = 24
# |t| of 22 degrees of freedom beyond this: 0.25 % of the pixels of equal pictures.
BOUND = 3.41

SCENE = """
import math
from bake_scenes import *

obj = monkey()
# Deformed enough that the highlights of rest would be seen to be others.
keyed_shape(obj, lambda p: p * (1.7, 0.8, 0.7) + 0.2 * p[:, [2, 0, 1]])
armature(obj)
subsurf(obj, levels=1, render_levels=1)
material = bpy.data.materials.new("Metal")
material.use_nodes = True
obj.data.materials.append(material)
shader = material.node_tree.nodes["Principled BSDF"]
shader.inputs["Metallic"].default_value = 1
shader.inputs["Roughness"].default_value = 0.4

scene = cycles(40, 40, samples=ARGUMENTS["samples"])
scene.frame_set(4)
camera((1.2, -4, 1.2), ortho_scale=4)
lamp = bpy.data.lights.new("Lamp", "AREA")
lamp.energy, lamp.size = 300, 2
light = bpy.data.objects.new("Lamp", lamp)
scene.collection.objects.link(light)
light.location = (2, -3, 4)
light.rotation_euler = (math.radians(40), 0, math.radians(35))
scene.world = bpy.data.worlds.new("World")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.3, 1)

def pictures():
    out = []
    for seed in range(ARGUMENTS["seeds"]):
        scene.cycles.seed = seed
        out.append(render()[..., :3])
    return np.array(out)

bpy.ops.ltmd.setup(object_name=obj.name)
from blender_addon import surface
live = pictures()
surface.lobe(material).inputs["Strength"].default_value = 0
rest = pictures()
surface.lobe(material).inputs["Strength"].default_value = 1
bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS["folder"] + "/scene.blend")
# Few texels: 4.5 filters textures that are finer than the pixels, 5.2 hardly.
bpy.ops.ltmd.bake(frames="1-4", size=64, directory=ARGUMENTS["folder"], allow_overlap=True)
assert obj.ltmd.source == "TEXTURE"
scene.frame_set(4)
report(version=bpy.app.version_string, live=live, rest=rest, texture=pictures())
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    out = {}
    for blender in BLENDERS:
        folder = tmp_path_factory.mktemp(f"blender{blender}")
        arguments = {"folder": str(folder), "seeds": SEEDS, "samples": SAMPLES}
        out[blender] = run(SCENE, arguments=arguments, blender=blender)
        out[blender]["folder"] = folder
    return out


def beyond(first, second):
    """The share of values whose means differ by more than the noise of the seeds allows."""
    first, second = (np.asarray(pictures, float) for pictures in (first, second))
    difference = np.abs(first.mean(axis=0) - second.mean(axis=0))
    noise = np.sqrt((first.var(axis=0, ddof=1) + second.var(axis=0, ddof=1)) / SEEDS)
    # Where nothing is random, such as the background, float32 rounding is left.
    return (difference > BOUND * noise + 1e-5).mean()


def test_each_ran_in_its_own_blender(found):
    for blender in BLENDERS:
        assert found[blender]["version"].startswith(blender)


def test_baked_texels_are_the_same(found):
    for frame in range(1, 5):
        name = f"Suzanne_tension.{frame:04d}.exr"
        first, second = (reference.read(found[b]["folder"] / name) for b in BLENDERS)
        error = np.abs(first - second).max() / np.abs(first).max()
        assert error <= 1e-5, f"{name}: {error:.2e}"


@pytest.mark.parametrize("source", ["live", "texture", "rest"])
def test_pictures_are_the_same_within_noise(found, source):
    first, second = (found[blender][source] for blender in BLENDERS)
    share = beyond(first, second)
    assert share <= 0.01, f"{100 * share:.2f} % of the values differ"
    assert np.mean(first) == pytest.approx(np.mean(second), rel=5e-3)


def test_the_comparison_sees_the_deformation(found):
    assert beyond(found["4.5"]["live"], found["5.2"]["rest"]) > 0.1
