# SPDX-License-Identifier: Apache-2.0
"""The contract's OSL reader, as printed, rendered in Cycles against the expected numbers."""

import json
import shutil

import numpy as np
from blender_process import ROOT, run

SAMPLES = ROOT / "docs" / "samples"


def test_the_osl_reader_gives_the_expected_numbers(tmp_path):
    points = json.loads((SAMPLES / "expected.json").read_text())["points"]
    # Blender compiles a shader beside its source. One lobe a point, in turns, keeps this short.
    shader = shutil.copy(SAMPLES / "read_tension.osl", tmp_path)
    for index, point in enumerate(points):
        point["lobes"] = [point["lobes"][index % 3]]
    result = run(
        f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""
        + """
cycles(1, 1)
affine_quad([[1, 0], [0, 1]])
camera((0, 0, 3), ortho_scale=0.5)
tree, output = material(bpy.data.objects["Quad"])
script = tree.nodes.new("ShaderNodeScript")
script.mode = "EXTERNAL"
script.filepath = ARGUMENTS["shader"]
uv = tree.nodes.new("ShaderNodeCombineXYZ")
tree.links.new(uv.outputs[0], script.inputs["UV"])
def value(socket):
    show(tree, output, script.outputs[socket])
    return render()[0, 0, :3]
out = []
for point in ARGUMENTS["points"]:
    parts = point["file"].split(".")
    script.inputs["Tile"].default_value = int(parts[1]) if len(parts) == 4 else 1001
    script.inputs["File"].default_value = os.path.join(ARGUMENTS["samples"], point["file"])
    for k in range(2):
        uv.inputs[k].default_value = point["uv"][k]
    lobes = []
    for case in point["lobes"]:
        script.inputs["AlphaU"].default_value, script.inputs["AlphaV"].default_value = case["alpha"]
        for k, name in enumerate(("M0U", "M0V")):
            script.inputs[name].default_value = (case["m0"][0][k], case["m0"][1][k], 0)
        lobes.append(value("Lobe"))
    out.append(dict(tension=value("Tension"), lobes=lobes))
script.inputs["File"].default_value = os.path.join(ARGUMENTS["samples"], "absent.exr")
report(out=out, missing=value("Tension"))
""",
        arguments={"samples": str(SAMPLES), "shader": shader, "points": points},
        addon=False,
        blender="4.5",  # Cycles 5.2 answers texture() of a file's name with the picture's mean
    )
    assert result["missing"] == [1, 0, 1]
    for point, got in zip(points, result["out"], strict=True):
        np.testing.assert_allclose(got["tension"], point["tension"], rtol=1e-5, atol=1e-5)
        for case, lobe in zip(point["lobes"], got["lobes"], strict=True):
            np.testing.assert_allclose(lobe[:2], case["lobe"][:2], rtol=1e-5)
            turn = (lobe[2] - case["lobe"][2] + np.pi / 2) % np.pi - np.pi / 2
            assert abs(turn) < 1e-5, (point, case, lobe)
            assert 0 <= lobe[2] < np.float32(np.pi)
