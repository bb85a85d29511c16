# SPDX-License-Identifier: Apache-2.0
"""LTMD Normal: slopes of bumps under tension, against float64."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
from blender_addon.nodes import normal
"""
    + """
cycles(8, 8)
view = camera((0, 0, 3), ortho_scale=0.5)
A = np.array(ARGUMENTS["matrix"])

def scene(back=False):
    if "Quad" in bpy.data.objects:
        bpy.data.objects.remove(bpy.data.objects["Quad"])
    obj = affine_quad(A)
    view.location.z = -3 if back else 3
    view.rotation_euler = (np.pi, 0, 0) if back else (0, 0, 0)
    tree, output = material(obj)
    tension, bend = group(tree, live_tension), group(tree, normal)
    uv = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(uv.outputs[0], tension.inputs["UV"])
    for name in ("Tension", "Tangent"):
        tree.links.new(tension.outputs[name], bend.inputs[name])
    return tree, output, bend, uv.outputs[0]

def value(tree, output, bend, **inputs):
    for name, value in inputs.items():
        bend.inputs[name.replace("_", " ")].default_value = value
    show(tree, output, bend.outputs["Normal"])
    return render()[4, 4, :3]
"""
)
MATRIX = [[1.7, 0.5], [0.3, 0.6]]
OPTIONS = [
    {},
    {"Strength": 0.0},
    {"Strength": 0.5},
    {"Strength": 1.0, "Height_Response": 1.0},
    {"Height_Response": -0.5},
]


def polar_power(matrix, strength):
    """V^s Rot(s phi) of the matrix V Rot(phi)."""
    u, s, w = np.linalg.svd(matrix)
    turn = u @ w
    phi = strength * np.arctan2(turn[1, 0], turn[0, 0])
    c, d = np.cos(phi), np.sin(phi)
    return u @ np.diag(s**strength) @ u.T @ np.array([[c, -d], [d, c]])


def bent(matrix, slopes, option, frame):
    """The normal in space of a bump of these slopes at rest; columns of frame: X, Y."""
    m = polar_power(matrix, option.get("Strength", 1.0))
    heights = np.linalg.det(m) ** -option.get("Height_Response", 0.0)
    s = heights * np.linalg.inv(m).T @ np.asarray(slopes)
    n = np.array([*-(frame @ s), 1.0])
    return n / np.linalg.norm(n)


def frames(matrix):
    """X, Y of the deformed quad, whose U is its x at rest, and T in it."""
    x = np.asarray(matrix)[:, 0] / np.linalg.norm(np.asarray(matrix)[:, 0])
    frame = np.array([x, [-x[1], x[0]]]).T
    return frame, frame.T @ np.asarray(matrix)


def test_a_normal_map_flattens_where_the_surface_stretches():
    result = run(
        PRELUDE
        + """
values = []
for back in (False, True):
    tree, output, bend, uv = scene(back)
    bump = tree.nodes.new("ShaderNodeNormalMap")
    bump.inputs["Color"].default_value = (*ARGUMENTS["colour"], 1)
    tree.links.new(bump.outputs[0], bend.inputs["Normal"])
    for option in ARGUMENTS["options"]:
        option = {"Strength": 1.0, "Height_Response": 0.0} | option
        values.append(value(tree, output, bend, **option))
    tree.links.remove(bend.inputs["Normal"].links[0])
    values.append(value(tree, output, bend))
report(values=values)
""",
        arguments={"matrix": MATRIX, "colour": [0.7, 0.35, 0.9], "options": OPTIONS},
    )
    n = 2 * np.array([0.7, 0.35, 0.9]) - 1
    frame, t = frames(MATRIX)
    want = [bent(t, -n[:2] / n[2], option, frame) for option in OPTIONS] + [np.array([0, 0, 1])]
    assert abs(want[0][2] - want[1][2]) > 0.02  # the deformation shows
    for index, got in enumerate(result["values"]):
        back = index >= len(want)
        expected = want[index % len(want)] * (-1 if back else 1)
        # The map's tangent is stored in 16 bits a component.
        assert np.allclose(got, expected, atol=1e-4), (index, got, expected)


def test_a_bump_has_followed_the_stretch_already():
    """Bump of a height that is linear in UV: Blender's slopes are T^-t times those at rest."""
    result = run(
        PRELUDE
        + """
values = []
for back in (False, True):
    tree, output, bend, uv = scene(back)
    height = tree.nodes.new("ShaderNodeVectorMath")
    height.operation = "DOT_PRODUCT"
    height.inputs[1].default_value = (*ARGUMENTS["height"], 0)
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = 1
    bump.inputs["Distance"].default_value = 1
    tree.links.new(uv, height.inputs[0])
    tree.links.new(height.outputs["Value"], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], bend.inputs["Normal"])
    bend.inputs["From Bump"].default_value = True
    show(tree, output, bump.outputs[0])
    plain = render()[4, 4, :3]
    for option in ARGUMENTS["options"]:
        option = {"Strength": 1.0, "Height_Response": 0.0} | option
        values.append(value(tree, output, bend, **option))
    assert np.allclose(values[-len(ARGUMENTS["options"])], plain, atol=1e-6)
report(values=values)
""",
        arguments={"matrix": MATRIX, "height": [0.8, -0.5], "options": OPTIONS},
    )
    frame, t = frames(MATRIX)
    # The quad's side is 2 and its UV's 1.
    slopes = np.array([0.8, -0.5]) / 2
    for index, got in enumerate(result["values"]):
        option, back = OPTIONS[index % len(OPTIONS)], index >= len(OPTIONS)
        # A bump is a dent from behind.
        expected = bent(t, slopes, option, frame) * (-1 if back else 1)
        assert np.allclose(got, expected, atol=1e-4), (index, got, expected)
