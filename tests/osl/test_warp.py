# SPDX-License-Identifier: Apache-2.0
"""LTMD Warp against analytic Jacobians of warped texture coordinates."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
from blender_addon.nodes import warp
"""
    + """
cycles(8, 8)
view = camera((0, 0, 3), ortho_scale=1.6)
UV = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
MIRRORED = np.array([(1, 0), (0, 0), (0, 1), (1, 1)], float)

def scene(uv, back):
    if "Quad" in bpy.data.objects:
        bpy.data.objects.remove(bpy.data.objects["Quad"])
    obj = affine_quad(np.eye(2), uv)
    view.location.z = -3 if back else 3
    view.rotation_euler = (np.pi, 0, 0) if back else (0, 0, 0)
    tree, output = material(obj)
    node = group(tree, warp)
    uv_map = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(uv_map.outputs[0], node.inputs["UV"])
    return tree, output, node, uv_map.outputs[0]

def affine(tree, uv, matrix):
    vector = tree.nodes.new("ShaderNodeCombineXYZ")
    for k, row in enumerate(matrix):
        product = tree.nodes.new("ShaderNodeVectorMath")
        product.operation = "DOT_PRODUCT"
        product.inputs[1].default_value = (*row, 0)
        tree.links.new(uv, product.inputs[0])
        tree.links.new(product.outputs["Value"], vector.inputs[k])
    return vector.outputs[0]

def outputs(tree, output, node):
    values = {}
    for name in ("Tension", "Tangent"):
        show(tree, output, node.outputs[name])
        values[name] = render()[..., :3]
    both = tree.nodes.new("ShaderNodeCombineXYZ")
    tree.links.new(node.outputs["Rotation"], both.inputs[0])
    tree.links.new(node.outputs["Shear"], both.inputs[1])
    show(tree, output, both.outputs[0])
    picture = render()
    return values | dict(Rotation=picture[..., 0], Shear=picture[..., 1])
"""
)


def rotation(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def material_matrix(rotate, shear):
    return rotation(rotate) @ np.array([[1, shear], [0, 1]]) @ np.diag([0.5, 2])


def triangular(t):
    return np.array([[t[0], t[1]], [0, t[2]]])


def test_affine_warps_act_as_their_jacobian():
    matrices = {
        "identity": [[1, 0], [0, 1]],
        "stretch": [[5, 0], [0, 0.2]],
        "skew": [[1, 0], [2, 1]],
        "turned": rotation(0.7).tolist(),
        "general": [[1.3, -0.8], [0.9, 0.6]],
        "mirror": [[-1, 0], [0, 1]],
        "general mirror": [[0.4, 1.2], [0.9, 0.5]],
    }
    deformation = [1.5, -0.4, 0.7]
    own = [0.6, 0.5]
    cases = [
        (name, mirrored, back, chained)
        for index, name in enumerate(matrices)
        for mirrored, back, chained in (
            ((0, 0, 0), (1, 1, 1)) if index % 2 else ((0, 1, 1), (1, 0, 0))
        )
    ]
    result = run(
        PRELUDE
        + """
values = []
for name, mirrored, back, chained in ARGUMENTS["cases"]:
    tree, output, node, uv = scene(MIRRORED if mirrored else UV, back)
    node.inputs["Rotation"].default_value, node.inputs["Shear"].default_value = ARGUMENTS["own"]
    if chained:
        node.inputs["Tension"].default_value = ARGUMENTS["deformation"]
    tree.links.new(affine(tree, uv, ARGUMENTS["matrices"][name]), node.inputs["Warp"])
    values.append({k: v[4, 4] for k, v in outputs(tree, output, node).items()})
report(values=values)
""",
        arguments={"cases": cases, "matrices": matrices, "deformation": deformation, "own": own},
    )
    assert len(result["values"]) == len(cases)
    for case, got in zip(cases, result["values"], strict=True):
        name, mirrored, _, chained = case
        j = np.array(matrices[name])
        side = np.diag([1, -1]) if mirrored else np.eye(2)
        t = triangular(deformation) if chained else np.eye(2)
        # What matters of M = T_deformation J M0 for a lobe is M M^t.
        want = t @ side @ j @ side @ material_matrix(*own)
        made = triangular(got["Tension"]) @ material_matrix(got["Rotation"], got["Shear"])
        assert got["Tension"][0] > 0 and got["Tension"][2] > 0, case
        # Rounding of the derivatives, grown by the factors.
        size = np.prod([np.linalg.norm(m, 2) for m in (t, j, material_matrix(*own))])
        assert np.abs(made @ made.T - want @ want.T).max() < 5e-6 * size**2, case
        assert np.allclose(got["Tangent"], (-1 if mirrored else 1, 0, 0), atol=1e-6), case


def test_a_curved_warp_is_exact_at_every_point():
    result = run(
        PRELUDE
        + """
tree, output, node, uv = scene(UV, False)
split, join = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeCombineXYZ")
power, add = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
power.operation, power.inputs[1].default_value = "POWER", 5
add.operation, add.inputs[1].default_value = "MULTIPLY_ADD", 2
link = tree.links.new
link(uv, split.inputs[0])
link(split.outputs[0], power.inputs[0])
link(power.outputs[0], add.inputs[0])
link(split.outputs[1], add.inputs[2])
link(split.outputs[0], join.inputs[0])
link(add.outputs[0], join.inputs[1])
link(join.outputs[0], node.inputs["Warp"])
values = outputs(tree, output, node)
show(tree, output, uv)
report(uv=render()[..., :3], **values)
"""
    )
    u = np.array(result["uv"])[..., 0]
    assert u.min() < 0.2 and u.max() > 0.8
    t, turn = np.array(result["Tension"]), np.array(result["Rotation"])
    slope = 10 * u**4
    # J = (1 0; slope 1) = T Rot: T T^t = J J^t = (1 slope; slope 1 + slope^2).
    across = np.sqrt(1 + slope**2)
    assert np.allclose(t, np.stack([1 / across, slope / across, across], -1), atol=2e-5)
    assert np.allclose(turn, np.arctan2(slope, 1), atol=1e-5)


def test_without_slopes_there_is_no_warp():
    result = run(
        PRELUDE
        + """
out = {}
tree, output, node, uv = scene(UV, False)
node.inputs["Tension"].default_value = (1.5, -.4, .7)
out["not linked"] = outputs(tree, output, node)
tree.links.new(affine(tree, uv, [[1, 1], [1, 1]]), node.inputs["Warp"])
out["collapsed"] = outputs(tree, output, node)
tree.links.new(affine(tree, uv, [[2, 0], [0, 1]]), node.inputs["Warp"])
tree.links.remove(node.inputs["UV"].links[0])
out["no UV map"] = outputs(tree, output, node)
report(**out)
"""
    )
    for name in ("not linked", "collapsed", "no UV map"):
        values = np.array(result[name]["Tension"])
        assert np.allclose(values, (1.5, -0.4, 0.7), atol=1e-6), (name, values[0, 0])
        assert np.abs(result[name]["Rotation"]).max() == 0, name
