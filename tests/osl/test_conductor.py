# SPDX-License-Identifier: Apache-2.0
"""One lobe of LTMD Conductor is the stock Metallic BSDF of equivalent alphas and tangent."""

import numpy as np
import pytest
from blender_process import ROOT, run

from blender_addon.metals import METALS, Metal

PRELUDE = f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""


def test_one_lobe_equals_the_metallic_node():
    result = run(
        PRELUDE
        + """
cycles(48, 48, samples=4)
tree, output, view = lit_plane()
metal = group(tree, conductor)
stock = tree.nodes.new("ShaderNodeBsdfMetallic")
stock.distribution = "GGX"
direction = tree.nodes.new("ShaderNodeCombineXYZ")
tree.links.new(direction.outputs[0], stock.inputs["Tangent"])
tangent = tree.nodes.new("ShaderNodeCombineXYZ")
tangent.inputs[0].default_value = 1
tree.links.new(tangent.outputs[0], metal.inputs["Tangent"])

def picture(node):
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return render()[..., :3]

cases = []
roughness = 0.45
for kind, fresnel in ((0, "F82"), (1, "PHYSICAL_CONDUCTOR")):
    stock.fresnel_type = fresnel
    metal.inputs["Conductor Type"].default_value = kind
    for name, value in (("Base Color", (.9, .6, .3, 1)), ("Edge Tint", (.8, .7, .9, 1)),
                        ("IOR", (.2, .9, 1.2)), ("Extinction", (3.2, 2.5, 1.9))):
        metal.inputs[name].default_value = value
        if name in stock.inputs:  # only those of its type
            stock.inputs[name].default_value = value
    for stretch, rotation, tension in ((0, 0, (1, 0, 1)), (.4, .6, (1, 0, 1)),
                                       (.2, 0, (1.6, .5, .8))):
        values = dict(Roughness=roughness, Stretch=stretch, Rotation=rotation, Tension=tension)
        for name, value in values.items():
            metal.inputs[name].default_value = value
        t = np.array([[tension[0], tension[1]], [0, tension[2]]])
        ax, ay, angle = lobe(roughness**2, t @ material_matrix(stretch, rotation, 0))
        assert ay / ax < 10 and ay < 1
        stock.inputs["Roughness"].default_value = (ax * ay) ** 0.25
        stock.inputs["Anisotropy"].default_value = (1 - ax / ay) / 0.9
        direction.inputs[0].default_value = -np.sin(angle)
        direction.inputs[1].default_value = np.cos(angle)
        for side in (1, -1):
            view(side)
            got, want = picture(metal), picture(stock)
            cases.append(dict(name=f"{fresnel} {stretch} {tension} {side}",
                              error=np.abs(got - want).max(), brightest=want.max()))
report(cases=cases)
"""
    )
    assert len(result["cases"]) == 12
    for case in result["cases"]:
        assert case["brightest"] > 0.1, case
        assert case["error"] < 1e-5 * max(1, case["brightest"]), case


def test_fresnel_factors_of_random_normals_are_the_closures():
    """The shaders' own Fresnel against float64; F82 meets both its colours."""
    values = run(
        PRELUDE
        + '''
path = os.path.join(os.environ["BLENDER_USER_RESOURCES"] + "_probe.osl")
open(path, "w").write("""
#include "stdcycles.h"
#include "ltmd_fresnel.h"
shader probe(float Cosine = 1, vector Eta = 1, vector Kappa = 1, color Base = 1, color Tint = 1,
             int Part = 0, output color Value = 0)
{
    if (Part == 0) Value = ltmd_fresnel_conductor(Cosine, (color)Eta, (color)Kappa);
    if (Part == 1) Value = ltmd_fresnel_f82(Cosine, Base, Tint);
    if (Part == 2) Value = ltmd_fresnel_dielectric(Cosine, Eta[0]);
}
""")
cycles(1, 1)
affine_quad([[1, 0], [0, 1]])
camera((0, 0, 3), ortho_scale=0.5)
tree, output = material(bpy.data.objects["Quad"])
probe = shader_node(tree, path)
show(tree, output, probe.outputs["Value"])
probe.inputs["Eta"].default_value = (.222, 1.5, 2.95)
probe.inputs["Kappa"].default_value = (3.208, 0, 2.93)
probe.inputs["Base"].default_value = (.9, .2, .5, 1)
probe.inputs["Tint"].default_value = (1, .5, .7, 1)
out = []
for cosine in (1, 0.6, 1 / 7, 0.01, 0):
    probe.inputs["Cosine"].default_value = cosine
    parts = []
    for part in range(3):
        probe.inputs["Part"].default_value = part
        parts.append(render()[0, 0, :3])
    out.append((cosine, parts))
report(out=out)
'''
    )
    metal = Metal((0.222, 1.5, 2.95), (3.208, 0, 2.93))
    for cosine, (exact, f82, dielectric) in values["out"]:
        np.testing.assert_allclose(exact, metal.reflectance(cosine), rtol=2e-6)
        glass = Metal((0.222,) * 3, (0,) * 3).reflectance(cosine)
        sine = np.sqrt(1 - cosine**2)
        expected = glass[0] if sine < 0.222 else 1.0
        np.testing.assert_allclose(dielectric, expected, rtol=2e-6)
        if cosine == 1:
            np.testing.assert_allclose(f82, (0.9, 0.2, 0.5), rtol=1e-6)
        if abs(cosine - 1 / 7) < 1e-9:
            base = np.array((0.9, 0.2, 0.5))
            schlick = base + (1 - base) * (6 / 7) ** 5
            np.testing.assert_allclose(f82, schlick * (1, 0.5, 0.7), rtol=1e-5)


@pytest.mark.parametrize("name", METALS)
def test_metals_are_metals(name):
    metal = METALS[name]
    for color in (metal.base_color(), metal.edge_tint()):
        assert len(color) == 3 and all(0.3 < channel <= 1 for channel in color)
    # What everyone knows of them.
    red, green, blue = metal.base_color()
    assert (red > 1.5 * blue) == (name in ("Gold", "Copper", "Brass"))
    assert (min(metal.base_color()) > 0.9) == (name in ("Silver", "Aluminium"))
