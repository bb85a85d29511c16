# SPDX-License-Identifier: Apache-2.0
"""What holds for all LTMD materials: roulette is the sum, nothing breaks at extreme inputs, and the
closures fit into the GPU's stack."""

import re

import numpy as np
from blender_process import ROOT, run

PRELUDE = f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""


def test_roulette_is_the_sum_in_the_mean():
    result = run(
        PRELUDE
        + """
scene = cycles(32, 32, samples=16)
tree, output, view = lit_plane()
view(1).data.ortho_scale = 1.2
out = {}
for module, tail in ((glossy, 1.2), (conductor, 3.0)):
    node = group(tree, module)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for name, value in (("Tail", tail), ("Lobes", 5), ("Tension", (1.5, .4, .8))):
        node.inputs[name].default_value = value
    for mode in (0, 1):
        node.inputs["Mode"].default_value = mode
        pictures = []
        for seed in range(6):
            scene.cycles.seed = seed
            pixels = render()[..., :3].mean(axis=-1)
            pictures.append(pixels.reshape(4, 8, 4, 8).mean(axis=(1, 3)).ravel())
        out[f"{module.NAME} {mode}"] = pictures
report(out=out)
"""
    )
    for name in ("LTMD Glossy", "LTMD Conductor"):
        total, picked = (np.array(result["out"][f"{name} {mode}"]) for mode in (0, 1))
        error = np.sqrt((total.var(axis=0, ddof=1) + picked.var(axis=0, ddof=1)) / 6)
        z = (total.mean(axis=0) - picked.mean(axis=0)) / error
        # Student's t of about 10 degrees of freedom; 32 blocks, 1 in 1000.
        assert np.abs(z).max() < 6, z
        # The test would see a lobe that is missed.
        assert error.mean() < 0.02 * total.mean()


def test_extreme_inputs_are_finite_and_lit():
    result = run(
        PRELUDE
        + """
cycles(10, 10, samples=16)
mesh_object("Plane", [(0, 0, 0), (5, 0, 0), (5, 5, 0), (0, 5, 0)], [(0, 1, 2, 3)],
            [(0, 0), (1, 0), (1, 1), (0, 1)])
world = bpy.context.scene.world = bpy.data.worlds.new("White")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
tree, output = material(bpy.data.objects["Plane"])
place = tree.nodes.new("ShaderNodeNewGeometry")
parts = tree.nodes.new("ShaderNodeSeparateXYZ")
tree.links.new(place.outputs["Position"], parts.inputs[0])

def steps(axis, values):
    ramp = tree.nodes.new("ShaderNodeMath")
    ramp.operation = "FLOOR"
    tree.links.new(parts.outputs[axis], ramp.inputs[0])
    scale = tree.nodes.new("ShaderNodeMath")
    scale.operation = "MULTIPLY"
    scale.inputs[1].default_value = values / 4
    tree.links.new(ramp.outputs[0], scale.inputs[0])
    return scale.outputs[0]

# Tail 0 to 4 along x, Roughness 0 to 1 along y: a cell of 2 x 2 pixels each.
tail, roughness = steps("X", 4), steps("Y", 1)
cases = []
for module in (glossy, conductor, dielectric):
    node = group(tree, module)
    tree.links.new(tail, node.inputs["Tail"])
    tree.links.new(roughness, node.inputs["Roughness"])
    for color in ("Color", "Base Color", "Edge Tint"):
        if color in node.inputs:
            node.inputs[color].default_value = (1, 1, 1, 1)
    if "Base" in node.inputs:
        diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
        tree.links.new(diffuse.outputs[0], node.inputs["Base"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for mode, lobes, tension in ((0, 6, (1, 0, 1)), (0, 0, (1e-3, 0, 1e3)), (1, 0, (1e3, 9, 1e3)),
                                 (0, 3, (1e-3, 0, 1e-3)), (0, 1, (1, 1e3, 1)),
                                 (0, 0, (np.nan, np.inf, -1))):
        node.inputs["Mode"].default_value = mode
        node.inputs["Lobes"].default_value = lobes
        node.inputs["Tension"].default_value = tension
        side = 1 if len(cases) % 2 else -1
        camera((2.5, 2.5, 3 * side), (2.5, 2.5, 0), ortho_scale=5)
        pixels = render()[..., :3]
        cases.append(dict(name=f"{module.NAME} {mode} {lobes} {tension} {side}",
                          squeezed=tension[0] < 1 or tension[1] > 100,
                          finite=bool(np.isfinite(pixels).all()), least=pixels.min(),
                          most=pixels.max()))
report(cases=cases)
"""
    )
    assert len(result["cases"]) == 18
    for case in result["cases"]:
        assert case["finite"], case
        # Single scattering of the roughest surface loses half, and 16 samples are few; squeezed it
        # loses nearly all.
        assert case["least"] > (0 if case["squeezed"] else 0.15), case
        assert case["most"] < 1.3, case


# Bytes that a closure takes of the 1024 that OptiX has for each shading point: its parameters with
# a header of 16, aligned to 8. A sum takes 24, a weight of its own too unless it is joined to its
# closure, which needs a multiplication by a colour as the next operation.
STACK, SUM = 1024, 24
BYTES = {
    "microfacet": 72, "conductor_bsdf": 96, "microfacet_f82_tint": 96, "dielectric_bsdf": 104,
    "reflection": 48, "layer": 32,
}  # fmt: skip


def test_closures_fit_into_the_stack():
    codes = run(
        PRELUDE
        + """
tree = bpy.data.node_groups.new("Test", "ShaderNodeTree")
codes = {}
for name, module in (("glossy", glossy), ("conductor", conductor), ("dielectric", dielectric)):
    node = group(tree, module)
    codes[name] = next(n for n in node.node_tree.nodes if n.type == "SCRIPT").bytecode
report(**codes)
"""
    )
    for shader, closures in (
        ("glossy", {"microfacet"}),
        ("conductor", {"conductor_bsdf", "microfacet_f82_tint"}),
        ("dielectric", {"dielectric_bsdf"}),
    ):
        check_stack(shader, closures, codes[shader])


def check_stack(shader, closures, code):
    names = dict(re.findall(r'^const\tstring\t(\$const\d+)\t"(\w+)"', code, re.MULTILINE))
    operations = [line.split() for line in code.splitlines() if line.startswith("\t")]
    colours = set(re.findall(r"^(?:local|temp)\tcolor\t(\S+)", code, re.MULTILINE))
    count = {}
    for this, following in zip(operations, operations[1:], strict=False):
        if this[0] != "closure":
            continue
        # With a ready weight the closure's name comes second.
        name = names.get(this[2]) or names[this[3]]
        count[name] = count.get(name, 0) + 1
        if name not in ("layer", "reflection"):
            assert following[0] == "mul" and following[3] in colours, (name, following)
    lobes = {name: number for name, number in count.items() if number == 6}
    assert set(lobes) == closures
    text = (ROOT / "osl" / f"ltmd_{shader}.osl").read_text()
    automatic = int(re.search(r"PreserveEnergy,\s+(\d), lobes", text)[1])
    assert automatic == (5 if shader == "glossy" else 4)
    rest = BYTES["layer"] * count.get("layer", 0)
    size = max(BYTES[name] for name in lobes)
    # Half of the stack is for the rest of the material, unless more lobes are asked for.
    assert automatic * size + (automatic - 1) * SUM + rest <= STACK // 2 + 8
    assert 6 * size + 5 * SUM + rest <= STACK
