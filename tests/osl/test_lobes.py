# SPDX-License-Identifier: Apache-2.0
"""The shaders' lobes are those of ltmd.fit_lobes."""

import ltmd
import numpy as np
from blender_process import ROOT, run

# One pixel for each alpha and gamma, which the shader makes from the pixel's place.
STEPS = 16
SHADER = """
#include "stdcycles.h"
#include "ltmd_inputs.h"

shader probe(
    float LobeTable[LTMD_LOBE_TABLE_SIZE] = { LTMD_LOBE_TABLE },
    int Count = 3,
    int Part = 0,
    output color Value = 0)
{
    int i = (int)floor(P[0]), j = (int)floor(P[1]);
    float alpha = exp(log(1e-4) * i / 15), gamma = 4.0 * j / 15;
    LtmdLobes l;
    ltmd_fit_lobes(LobeTable, alpha, gamma, ltmd_lobe_count(Count, alpha, gamma, 5), l);
    if (Part == 0) Value = color(l.alpha0, l.alpha1, l.alpha2);
    if (Part == 1) Value = color(l.alpha3, l.alpha4, l.alpha5);
    if (Part == 2) Value = color(l.weight0, l.weight1, l.weight2);
    if (Part == 3) Value = color(l.weight3, l.weight4, l.weight5);
    if (Part == 4) Value = l.ggx;
}
"""


def test_lobes_equal_the_library(tmp_path):
    (tmp_path / "probe.osl").write_text(SHADER)
    result = run(
        f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""
        + """
cycles(16, 16)
mesh_object("Plane", [(0, 0, 0), (16, 0, 0), (16, 16, 0), (0, 16, 0)], [(0, 1, 2, 3)])
camera((8, 8, 3), (8, 8, 0), ortho_scale=16)
tree, output = material(bpy.data.objects["Plane"])
probe = shader_node(tree, ARGUMENTS)
show(tree, output, probe.outputs["Value"])
out = {}
for count in range(7):
    probe.inputs["Count"].default_value = count
    parts = []
    for part in range(5):
        probe.inputs["Part"].default_value = part
        parts.append(render()[::-1, :, :3])
    out[count] = np.concatenate(parts, axis=-1)
report(out=out)
""",
        arguments=str(tmp_path / "probe.osl"),
    )
    alphas, gammas = 1e-4 ** (np.arange(STEPS) / 15), 4 * np.arange(STEPS) / 15
    for count in range(7):
        got = np.array(result["out"][str(count)])
        for j, gamma in enumerate(gammas):
            for i, alpha in enumerate(alphas):
                most = count or (3 if gamma <= 2 and alpha >= 0.1 else 5)
                want = ltmd.fit_lobes(max(alpha, 1e-4), gamma, most)
                cell = got[j, i]
                used = cell[6:12] > 0
                if alpha == 1:
                    # One lobe stands for the many of the table that are all alike.
                    assert np.array_equal(cell[[0, 6]], [1, 1]) and used.sum() == 1
                    continue
                where = (count, alpha, gamma)
                assert used.sum() == len(want.alpha), where
                # OSL's exp and log are approximations, good to about 1e-5 each.
                for lobes, expected in ((cell[:6], want.alpha), (cell[6:12], want.weight)):
                    np.testing.assert_allclose(lobes[used], expected, rtol=4e-5, err_msg=str(where))
                ggx = [k == "ggx" for k in want.kind]
                assert [k < cell[12] for k in np.flatnonzero(used)] == ggx, where
