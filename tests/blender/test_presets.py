# SPDX-License-Identifier: Apache-2.0
"""Presets: what they name is there, in range, and is what the papers print."""

import numpy as np
import pytest
from blender_process import run

PRESETS = """
from trees import *
from blender_addon import apply_preset, nodes, presets, surface
from blender_addon.nodes import dielectric

scene = cycles(16, 16, samples=4)
camera((0, -4, 3), ortho_scale=3)
lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
lamp.data.energy, lamp.data.size, lamp.location = 300, 2, (0, -1, 4)
scene.collection.objects.link(lamp)
obj = cube()
material = new_material("M", obj)
bpy.ops.ltmd.setup(object_name="Cube")
original = dump(material)
bad, values, looks = [], {}, {}
for key, preset in presets.PRESETS.items():
    bpy.ops.ltmd.preset(object_name="Cube", preset=key)
    node = surface.lobe(material)
    if surface.lobe_kind(node) != preset.group.NAME:
        bad.append([key, "group"])
    items = {i.name: i for i in node.node_tree.interface.items_tree if i.in_out == "INPUT"}
    for name, wanted in preset.sockets.items():
        found = value(node.inputs[name])
        flat = found if isinstance(found, list) else [found]
        want = list(wanted) if isinstance(wanted, tuple) else [wanted]
        low, high = (getattr(items[name], k, None) for k in ("min_value", "max_value"))
        inside = low is None or all(low <= v <= high for v in flat)
        if not np.allclose(flat, want, atol=1e-6) or not inside:
            bad.append([key, name, found, wanted])
    values[key] = {s.name: value(s) for s in node.inputs if s.type != "SHADER"}
    links = {s.name: s.links[0].from_node.name for s in node.inputs if s.is_linked}
    if links.get("Tension") != "LTMD Live Tension":
        bad.append([key, "tension"])
    if (preset.group == dielectric) != (links.get("Base") == "Diffuse BSDF"):
        bad.append([key, "base", links])
    if key in ("RUBBER_BALLOON", "GOLD", "VASE_160_10", "TORUS_KNOT"):
        looks[key] = render()[..., :3]
values = {k: v for k, v in values.items() if k in ARGUMENTS["keys"]}
groups = sorted(t["ltmd_group"] for t in bpy.data.node_groups if t.users)
bpy.ops.ltmd.remove(object_name="Cube")
left = len(bpy.data.node_groups)

# The user's own nodes stay: a texture keeps its say, and comes back.
picture = material.node_tree.nodes.new("ShaderNodeTexNoise")
for name in ("Base Color", "Roughness"):
    material.node_tree.links.new(picture.outputs[0], principled(material).inputs[name])
principled(material).inputs["Metallic"].default_value = .5
before = dump(material)
bpy.ops.ltmd.setup(object_name="Cube")
mix = next(n for n in surface.our_nodes(material) if n.type == "MIX_SHADER")
weight = mix.inputs[0].links[0].from_node.type
said = apply_preset.apply(material, presets.PRESETS["RUBBER_BALLOON"])
apply_preset.apply(material, presets.PRESETS["GOLD"])
alone = mix.inputs[0].is_linked, mix.inputs[0].default_value
apply_preset.apply(material, presets.PRESETS["TORUS_KNOT"])
rough = surface.lobe(material).inputs["Roughness"].links[0].from_node.type
weights = [weight, mix.inputs[0].links[0].from_node.type]
bpy.ops.ltmd.remove(object_name="Cube")
refused = ""
try:
    bpy.ops.ltmd.preset(object_name="Cube", preset="GOLD")
except RuntimeError as error:
    refused = str(error)
same = dump(material) == before

bpy.ops.ltmd.convert_material(object_name="Cube", method="DRIVE")
try:
    bpy.ops.ltmd.preset(object_name="Cube", preset="GOLD")
except RuntimeError as error:
    refused += str(error)
report(bad=bad, values=values, looks=looks, groups=groups, left=left, said=said,
       rough=rough, same=same, alone=alone, weights=weights, refused=refused)
"""

# alpha, gamma and the larger stretch of the material, as printed in microsurface-transformations.
PRINTED = {
    "BIRD": (0.25, 2.2, 1),
    "DOG": (0.16, 1.4, 1),
    "SILVER_PLATE": (0.0121, 1.7, 1),
    "SILVER_PLATE_STRETCHED": (0.0121, 1.7, 5),
    "VASE_10_10": (0.01, 1, 2.5),
    "VASE_40_10": (0.04, 1, 2.5),
    "VASE_160_10": (0.16, 1, 2.5),
    "VASE_10_35": (0.01, 3.5, 2.5),
    "VASE_40_35": (0.04, 3.5, 2.5),
    "VASE_160_35": (0.16, 3.5, 2.5),
    "TORUS_KNOT": (0.3, 1, 4),
}


def test_every_preset():
    found = run(PRESETS, arguments={"keys": [*PRINTED, "GOLD", "RUBBER_BALLOON"]})
    assert not found["bad"], found["bad"]
    for key, (alpha, gamma, stretch) in PRINTED.items():
        sockets = found["values"][key]
        assert sockets["Roughness"] ** 2 == pytest.approx(alpha, rel=1e-5), key
        assert not sockets["Roughness Is Alpha"], key
        assert sockets["Tail"] == pytest.approx(gamma), key
        # Equation 31: M = diag(1 / (1 - s), 1 - s).
        assert 1 / (1 - sockets["Stretch"]) == pytest.approx(stretch, rel=1e-4), key
    assert found["values"]["GOLD"]["Extinction"][0] > 3
    pictures = {key: np.array(look) for key, look in found["looks"].items()}
    gold, balloon = pictures["GOLD"].mean((0, 1)), pictures["RUBBER_BALLOON"].mean((0, 1))
    assert gold[0] > 1.3 * gold[2] and balloon[0] > 3 * balloon[1]
    for picture in pictures.values():
        assert np.isfinite(picture).all() and picture.max() > 0.02
    assert found["groups"] == ["LTMD Glossy", "LTMD Live Tension"] and found["left"] == 0

    assert found["rough"] == "TEX_NOISE" and "Roughness, Base Color" in found["said"][0]
    assert found["alone"] == [False, 1.0] and found["weights"] == ["MATH", "MATH"]
    assert found["same"] and "not set up" in found["refused"]
    assert "convert it by replacing" in found["refused"]


TWINS = """
from trees import *
from blender_addon import surface
cycles(osl=False)
obj = cube()
material = new_material("M", obj)
before = dump(material)
bpy.ops.ltmd.setup(object_name="Cube", use_osl=False)
twins = []
for key in ("GOLD", "RUBBER_BALLOON", "TORUS_KNOT"):
    bpy.ops.ltmd.preset(object_name="Cube", preset=key)
    node = surface.lobe(material)
    twins.append([node.node_tree["ltmd_group"], value(node.inputs["Tail"])])
bpy.ops.ltmd.remove(object_name="Cube")
report(twins=twins, same=dump(material) == before)
"""


@pytest.mark.long
def test_a_device_without_osl_gets_the_twins():
    found = run(TWINS)
    kinds = ("Conductor", "Dielectric", "Glossy")
    assert [name for name, _ in found["twins"]] == [f"LTMD {kind} (no OSL)" for kind in kinds]
    assert [tail for _, tail in found["twins"]] == pytest.approx([2.0, 1.7, 1.0])
    assert found["same"]
