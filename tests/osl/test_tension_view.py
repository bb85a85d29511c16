# SPDX-License-Identifier: Apache-2.0
"""LTMD Tension View: the colours, the same without OSL, and strokes that run the right way."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
from blender_addon.nodes import tension_view_no_osl
"""


def test_false_colour_is_grey_at_rest_red_stretched_blue_squeezed():
    result = run(
        PRELUDE
        + """
cycles(4, 4)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])
camera((0, 0, 3), ortho_scale=0.5)
tree, output = material(obj)
view = group(tree, tension_view)
view.inputs["Shading"].default_value = 0
tree.links.new(view.outputs[0], output.inputs["Surface"])
out = {}
for name, t, mode in (
    ("rest", (1, 0, 1), 0), ("stretched", (2, 0, 1), 0), ("squeezed", (1, 0, .5), 0),
    ("slanted", (1, 1, 1), 0), ("same area", (2, 0, .5), 1), ("more area", (2, 0, 1), 1),
    ("turned", (1, 0, 2), 0), ("more", (4, 0, 1), 0),
):
    view.inputs["Tension"].default_value = t
    view.inputs["Mode"].default_value = mode
    out[name] = render()[2, 2, :3]
report(**out)
"""
    )
    red, green, blue = result["rest"]
    assert red == green == blue > 0.3
    assert result["stretched"][0] > 10 * result["stretched"][2]
    assert result["squeezed"][2] > 5 * result["squeezed"][0]
    assert np.allclose(result["stretched"], result["turned"])
    assert result["same area"] == result["rest"]
    assert result["more area"][0] > 10 * result["more area"][2]
    assert result["more"][0] < result["stretched"][0]
    assert min(result["slanted"][0], result["slanted"][2]) > 1.8 * result["slanted"][1]  # purple


def test_the_view_without_osl_has_the_same_colours():
    result = run(
        PRELUDE
        + """
cycles(4, 4)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])
camera((1, 2, 3), ortho_scale=0.1)
tree, output = material(obj)
rng = np.random.default_rng(0)
tensions = [(1, 0, 1), (2, 0, .5), (.3, 0, .3), (1, 0, 0.01), (30, 0, 1)]
tensions += [(a, c, b) for a, b, c in zip(*np.exp(rng.normal(0, .5, (2, 6))), rng.normal(0, 1, 6))]
cases = [(t, mode, 1.7 + mode, .5 * mode) for t in tensions for mode in (0, 1)]
out = {}
for module in (tension_view, tension_view_no_osl):
    bpy.context.scene.cycles.shading_system = module == tension_view
    view = group(tree, module)
    tree.links.new(view.outputs[0], output.inputs["Surface"])
    out[module.NAME] = []
    for case in cases:
        for name, v in zip(("Tension", "Mode", "Range", "Shading"), case):
            view.inputs[name].default_value = v
        out[module.NAME].append(render()[2, 2, :3])
# Strokes need derivatives: mode 2 is the magnitude.
view.inputs["Tension"].default_value = (2, 0.3, 1)
pair = []
for mode in (0, 2):
    view.inputs["Mode"].default_value = mode
    pair.append(render()[2, 2, :3])
report(out=list(out.values()), pair=pair, osl=bpy.context.scene.cycles.shading_system)
"""
    )
    osl, stock = np.array(result["out"])
    print(f"largest difference {np.abs(osl - stock).max():.1e}")
    # float32 logarithms of numbers near 1, cubed.
    assert np.abs(osl - stock).max() < 1e-5
    assert osl.std(axis=0).min() > 0.05
    assert result["pair"][0] == result["pair"][1] and not result["osl"]


STROKES = (
    PRELUDE
    + """
cycles(96, 96, samples=4)
eye = camera((0, 0, 5), ortho_scale=0.6)
bpy.context.scene.view_settings.view_transform = "Raw"
out = []
for matrix, mirrored, below in ARGUMENTS["cases"]:
    uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    obj = affine_quad(matrix, uv * (-1, 1) if mirrored else uv)
    eye.location.z, eye.rotation_euler.x = (-5, np.pi) if below else (5, 0)
    tree, output = material(obj)
    tension, view = group(tree, live_tension), group(tree, tension_view)
    coordinates = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(coordinates.outputs[0], tension.inputs["UV"])
    for name in ("Tension", "Tangent"):
        tree.links.new(tension.outputs[name], view.inputs[name])
    tree.links.new(view.outputs[0], output.inputs["Surface"])
    view.inputs["Mode"].default_value = 2
    view.inputs["Density"].default_value = 12
    view.inputs["Range"].default_value = 1.5
    out.append(render()[..., 1])
    bpy.data.objects.remove(obj)
report(out=out)
"""
)


def test_strokes_run_along_the_larger_stretch():
    matrices = [
        [[2, 0], [0, 1]],
        [[1, 0], [0, 2]],
        [[1, 1.5], [0, 1]],
        [[0.5, -0.4], [0.9, 1.2]],
    ]
    cases = [(m, 0, 0) for m in matrices]
    cases += [(matrices[3], 1, 0), (matrices[3], 0, 1), ([[1.4, 0], [0, 1.4]], 0, 0)]
    pictures = np.array(run(STROKES, arguments={"cases": cases})["out"])
    for (matrix, _mirrored, below), picture in zip(cases[:-1], pictures, strict=False):
        u, _s, _v = np.linalg.svd(np.array(matrix, float))
        wanted = np.arctan2(u[1, 0], u[0, 0])
        smooth = picture
        for axis in (0, 1) * 3:  # differences of neighbours are exact for slow changes only
            smooth = (np.roll(smooth, 1, axis) + 2 * smooth + np.roll(smooth, -1, axis)) / 4
        down, right = np.gradient(smooth)
        # Image rows run down; from below the camera has y upside down.
        up = down if below else -down
        tensor = np.array([[(right**2).sum(), (right * up).sum()], [0, (up**2).sum()]])
        values, vectors = np.linalg.eigh(tensor, UPLO="U")
        found = np.arctan2(vectors[1, 0], vectors[0, 0])
        apart = np.degrees(np.abs((found - wanted + np.pi / 2) % np.pi - np.pi / 2))
        # Some dozens of strokes with round ends.
        assert apart < 3, (matrix, _mirrored, below, apart)
        assert values[1] > 3 * values[0]
        assert np.quantile(picture, 0.05) < 0.4 * np.quantile(picture, 0.95)
    # The same stretch in all directions has none of its own.
    assert np.ptp(pictures[-1]) < 1e-5
