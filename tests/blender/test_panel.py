# SPDX-License-Identifier: Apache-2.0
"""The panel's words follow the material, and what they set is in the nodes."""

import numpy as np
import pytest
from blender_process import run

PANEL = """
from layout import Layout
from trees import *
import version_1
from blender_addon import false_colour, nodes, panel, surface
from blender_addon.nodes import glossy_no_osl

def words():
    kept = []
    panel.draw(Layout(kept), bpy.context)
    return " ".join(kept)

obj = cube()
material = new_material("M", obj)
plain = words()
bpy.ops.ltmd.setup(object_name="Cube")
glossy = words()
bpy.ops.ltmd.setup(object_name="Cube", source="TENSOR")
tensor = words()
bpy.ops.ltmd.setup(object_name="Cube", source="LIVE")
bake = []
panel.draw_bake(Layout(bake), bpy.context)
node = surface.lobe(material)
settings = material.ltmd
modes = [settings.mode]
settings.mode = "REFERENCE"
modes += [settings.mode, node.inputs["Mode"].default_value]

limits = []
for rough, exact, stretch, shear, strength, response in ARGUMENTS["lobes"]:
    for name, v in (("Roughness", rough), ("Roughness Is Alpha", bool(exact)), ("Stretch", stretch),
                    ("Shear", shear), ("Strength", strength), ("Height Response", response)):
        node.inputs[name].default_value = v
    limits.append(surface.roughest(node))

twin = nodes.group_node(material.node_tree, glossy_no_osl)
twin.inputs["Roughness"].default_value = 0.7
limits_without_osl = surface.roughest(twin)
material.node_tree.nodes.remove(twin)

bpy.ops.ltmd.preset(object_name="Cube", preset="GOLD")
gold = words(), settings.metal
kinds = []
for metal in ("VALUES", "SILVER", "COLOUR"):
    settings.metal = metal
    node = surface.lobe(material)
    kinds.append([words(), settings.metal, node.inputs["Conductor Type"].default_value,
                  value(node.inputs["IOR"])])
bpy.ops.ltmd.show_tension(object_name="Cube")
shown = words()
settings.view = "DIRECTIONS"
directions = words(), false_colour.views(material)[0].inputs["Mode"].default_value

other = cube("Other")
version_1.set_up(other, new_material("Old", other))
bpy.context.view_layer.objects.active = other
old = words()
bpy.ops.ltmd.update_nodes()
report(plain=plain, glossy=glossy, tensor=tensor, bake=" ".join(bake), modes=modes, limits=limits,
       limits_without_osl=limits_without_osl, gold=gold, kinds=kinds, shown=shown,
       directions=directions, old=old, updated=words())
"""

LOBES = [
    # roughness, is it alpha, stretch, shear, strength, height response
    (0.5, 0, 0, 0, 1, 0),
    (0.7, 0, 0, 0, 1, 0),
    (0.5, 1, 0, 0, 1, 0),
    (0.5, 0, 0.6, 0, 1, 0),
    (0.5, 0, -0.6, 0.7, 1, 0),
    (0.5, 0, 0.9, 0, 1, 0),
    (0.7, 0, 0, 0, 0.5, 1),
    (0.7, 0, 0, 0, 2, 0),
    (0.7, 0, 0, 0, 0, 0),
]


@pytest.fixture(scope="module")
def found():
    return run(PANEL, arguments={"lobes": LOBES})


def test_the_panel_says_what_is_set(found):
    assert "Not set up" in found["plain"] and "Show Tension" not in found["plain"]
    for word in ("Roughness", "Tail", "Lobes", "Mode", "Preset", "ltmd.show_tension"):
        assert word in found["glossy"], word
    assert "ltmd.store_tension" in found["tensor"]
    assert "ltmd.store_tension" not in found["glossy"]
    assert "Resume" in found["bake"]
    assert found["modes"] == ["ALL", "REFERENCE", 2]
    words, kind = found["gold"]
    assert kind == "GOLD" and "Extinction" in words and "Edge Tint" not in words
    # Gold's own values are still gold.
    (words, kind, number, gold), (_, silver, _, ior), (colours, last, zero, _) = found["kinds"]
    assert (kind, number) == ("GOLD", 1) and gold == pytest.approx([0.222, 0.428, 1.334], rel=1e-5)
    assert silver == "SILVER" and ior == pytest.approx([0.058, 0.060, 0.047], rel=1e-5)
    assert last == "COLOUR" and zero == 0
    assert "Edge Tint" in colours and "Extinction" not in colours
    assert "Red: 2 times the length" in found["shown"] and "Strokes" not in found["shown"]
    words, number = found["directions"]
    assert number == 2 and "Strokes lie along" in words
    assert "ltmd.update_nodes" in found["old"] and "older version" in found["old"]
    assert "ltmd.update_nodes" not in found["updated"]


def test_where_the_roughness_of_cycles_ends(found):
    assert "dimmer" in found["limits"][1] and "too bright" in found["limits_without_osl"]
    for lobe, said in zip(LOBES, found["limits"], strict=True):
        rough, exact, stretch, shear, strength, response = lobe
        sx = 1 + stretch if stretch < 0 else 1 / (1 - stretch)
        m0 = np.array([[1, shear], [0, 1]]) @ np.diag([sx, 1 / sx])
        alpha = rough if exact else rough**2

        def widest(q, alpha=alpha, m0=m0, strength=strength, response=response):
            # The squeeze lies along the direction in which the material is widest already.
            u, s, _ = np.linalg.svd(m0)
            t = u @ np.diag([1, q**strength]) @ u.T
            heights = np.linalg.det(t) ** -response
            return alpha * heights / np.linalg.svd(t @ m0, compute_uv=False)[1]

        if widest(1) >= 1:
            assert "Already at rest" in said
        elif widest(1 / 3) <= 1:
            assert said is None, (rough, strength, said)
        else:
            low, high = 1 / 3, 1
            while high - low > 1e-6:
                middle = (low + high) / 2
                low, high = (middle, high) if widest(middle) > 1 else (low, middle)
            assert int(said.split("%")[0].split()[-1]) == pytest.approx(100 * low, abs=0.51)
