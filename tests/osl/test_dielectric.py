# SPDX-License-Identifier: Apache-2.0
"""LTMD Dielectric: its coat is that of the Principled BSDF, and the base gets what is left."""

from blender_process import ROOT, run

PRELUDE = f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
cycles(48, 48, samples=16)
tree, output, view = lit_plane()
coat = group(tree, dielectric)
base = tree.nodes.new("ShaderNodeBsdfDiffuse")
base.inputs["Color"].default_value = (.8, .3, .1, 1)
tree.links.new(base.outputs[0], coat.inputs["Base"])

def picture(node):
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return render()[..., :3]
"""


def test_one_lobe_equals_principled():
    result = run(
        PRELUDE
        + """
stock = tree.nodes.new("ShaderNodeBsdfPrincipled")
stock.distribution = "GGX"
stock.inputs["Base Color"].default_value = (.8, .3, .1, 1)
stock.inputs["IOR"].default_value = coat.inputs["IOR"].default_value = 1.8
direction = tree.nodes.new("ShaderNodeCombineXYZ")
tree.links.new(direction.outputs[0], stock.inputs["Tangent"])
tangent = tree.nodes.new("ShaderNodeCombineXYZ")
tangent.inputs[0].default_value = 1
tree.links.new(tangent.outputs[0], coat.inputs["Tangent"])
cases = []
for roughness, tension in ((.45, (1, 0, 1)), (.45, (1.6, .5, .8)), (.2, (.7, .2, 1.4))):
    coat.inputs["Roughness"].default_value = roughness
    coat.inputs["Tension"].default_value = tension
    ax, ay, angle = lobe(roughness**2, [[tension[0], tension[1]], [0, tension[2]]])
    assert ay / ax < 10 and ay < 1
    stock.inputs["Roughness"].default_value = (ax * ay) ** 0.25
    stock.inputs["Anisotropic"].default_value = (1 - ax / ay) / 0.9
    direction.inputs[0].default_value = -np.sin(angle)
    direction.inputs[1].default_value = np.cos(angle)
    for side in (1, -1):
        view(side)
        got, want = picture(coat), picture(stock)
        cases.append(dict(name=f"{roughness} {tension} {side}", error=np.abs(got - want).max(),
                          brightest=want.max()))
report(cases=cases)
"""
    )
    for case in result["cases"]:
        assert case["brightest"] > 0.1, case
        assert case["error"] < 1e-5 * max(1, case["brightest"]), case


def test_base_is_seen_and_energy_is_never_gained():
    result = run(
        PRELUDE
        + """
view(1)
coat.inputs["IOR"].default_value = 1
none = np.abs(picture(coat) - picture(base)).max()
world = bpy.context.scene.world = bpy.data.worlds.new("White")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
bpy.data.objects.remove(bpy.data.objects["Light"])
base.inputs["Color"].default_value = (1, 1, 1, 1)
coat.inputs["IOR"].default_value = 1.5
cycles(16, 16, samples=256)
furnace = []
for height in (1, .07):  # at 45 degrees and at a grazing angle
    camera((0, 1, height), ortho_scale=0.2 * height)
    for tail in (0, 1, 2, 4):
        for roughness in (0, .4, 1):
            coat.inputs["Tail"].default_value = tail
            coat.inputs["Roughness"].default_value = roughness
            pixels = picture(coat)
            furnace.append((height, tail, roughness, pixels.mean(), pixels.std() / 16))
report(none=none, furnace=furnace)
"""
    )
    assert result["none"] < 1e-6
    for case in result["furnace"]:
        _, tail, _, mean, deviation = case
        # layer() takes the share of a Beckmann lobe from a table of GGX, whose masking is stronger.
        most = 1 if tail <= 2 else 1.07
        assert mean < most + 4 * deviation + 1e-3, case
        assert mean > 0.95, case  # what single scattering loses of a coat is little
