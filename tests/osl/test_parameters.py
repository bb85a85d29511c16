# SPDX-License-Identifier: Apache-2.0
"""LTMD Parameters drives stock nodes to the same picture as LTMD's own materials."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
tree, output, view = lit_plane()
numbers = group(tree, parameters)
tangent = tree.nodes.new("ShaderNodeCombineXYZ")
tangent.inputs[0].default_value = 1
tree.links.new(tangent.outputs[0], numbers.inputs["Tangent"])
"""

# OSL's sine, cosine and power are approximations, good to about 1e-5.
TOLERANCE = 2e-5

CASES = (
    {"Roughness": 0.45},
    {"Roughness": 0.45, "Stretch": 0.3, "Rotation": 0.6, "Shear": 0.4},
    {"Roughness": 0.45, "Stretch": 0.2, "Tension": (1.6, 0.7, 0.8), "Height Response": 1},
    # Beyond alpha 1, where the materials keep their energy and stock nodes do not.
    {"Roughness": 0.9, "Tension": (0.5, 0.2, 1.2), "Strength": 1.3},
)


def test_stock_nodes_driven_by_the_parameters_equal_the_materials():
    result = run(
        PRELUDE
        + """
cycles(48, 48, samples=4)
pairs = []
for kind, module, links in (
    ("ShaderNodeBsdfAnisotropic", glossy,
     {"Roughness": "Roughness", "Anisotropy": "Anisotropy", "Tangent": "Tangent"}),
    ("ShaderNodeBsdfMetallic", conductor,
     {"Roughness": "Roughness", "Anisotropic": "Anisotropy", "Principled Tangent": "Tangent"}),
):
    stock, ours = tree.nodes.new(kind), group(tree, module)
    stock.distribution = "GGX"
    for color in ("Color", "Base Color", "Edge Tint"):
        for node in (stock, ours):
            if color in node.inputs:
                node.inputs[color].default_value = (.9, .6, .3, 1)
    for source, target in links.items():
        tree.links.new(numbers.outputs[source], stock.inputs[target])
    tree.links.new(tangent.outputs[0], ours.inputs["Tangent"])
    pairs.append((stock, ours))

def picture(node):
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return render()[..., :3]

cases = []
for values in ARGUMENTS:
    for stock, ours in pairs:
        for name, value in values.items():
            numbers.inputs[name].default_value = ours.inputs[name].default_value = value
        side = 1 if len(cases) % 2 else -1
        view(side)
        got, want = picture(stock), picture(ours)
        cases.append([ours.name, values, side, want.max(), np.abs(got - want).max()])
report(cases=cases)
""",
        arguments=CASES[:3],
    )
    assert len(result["cases"]) == 6
    for *case, brightest, error in result["cases"]:
        assert brightest > 0.1, case
        assert error < 1e-5 * max(1, brightest), (case, error)


def test_numbers_equal_the_model():
    result = run(
        PRELUDE
        + """
cycles(1, 1)
camera((0, 0, 3), ortho_scale=0.5)
out = []
for values in ARGUMENTS:
    for name, value in values.items():
        numbers.inputs[name].default_value = value
    got = {}
    for name in ("Alpha X", "Alpha Y", "Tangent", "Principled Tangent", "Alpha Squared"):
        show(tree, output, numbers.outputs[name])
        got[name] = render()[0, 0, :3]
    t = numbers.inputs["Tension"].default_value
    strength = numbers.inputs["Strength"].default_value
    roughness = numbers.inputs["Roughness"].default_value
    m = strengthened(t, strength) @ material_matrix(*(numbers.inputs[n].default_value for n in
                                                      ("Stretch", "Rotation", "Shear")))
    h = (t[0] * t[2]) ** (-strength * numbers.inputs["Height Response"].default_value)
    inverse = np.linalg.inv(m)
    sigma = roughness**4 * h**2 * inverse.T @ inverse
    out.append([got, sigma, lobe(roughness**2, m, h)])
report(out=out)
""",
        arguments=CASES,
    )
    for got, sigma, (ax, ay, angle) in result["out"]:
        xx, xy, yy = got["Alpha Squared"]
        scale = np.abs(sigma).max()
        np.testing.assert_allclose([[xx, xy], [xy, yy]], sigma, atol=TOLERANCE * scale)
        np.testing.assert_allclose(got["Alpha X"], ax, rtol=TOLERANCE)
        np.testing.assert_allclose(got["Alpha Y"], ay, rtol=TOLERANCE)
        smooth, rough = np.array(got["Tangent"]), np.array(got["Principled Tangent"])
        if ay > 1.001 * ax:
            along = np.array([np.cos(angle), np.sin(angle), 0])
            assert abs(abs(smooth @ along) - 1) < 1e-5
        assert abs(smooth @ rough) < 1e-6 and abs(rough @ rough - 1) < 1e-6
