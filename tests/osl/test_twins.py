# SPDX-License-Identifier: Apache-2.0
"""The materials by stock nodes give the numbers and the pictures of those in OSL."""

import ltmd
import numpy as np
import pytest
from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""
    + """
import importlib
from blender_addon.nodes import glossy_no_osl, gtr_lobes, parameters_no_osl

def pair(name):
    # The module of a group in OSL and that of its twin.
    return [importlib.import_module(f"blender_addon.nodes.{name}{end}") for end in ("", "_no_osl")]

def show_value(socket):
    show(tree, output, socket)
    return render()[2, 2, :3]
"""
)


def test_parameters_equal_the_model():
    """Of a lobe under the tension and the material's own matrix, in float64."""
    result = run(
        PRELUDE
        + """
cycles(4, 4, samples=1, osl=False)
obj = affine_quad(np.eye(2))
camera((0, 0, 3), ortho_scale=1)
tree, output = material(obj)
node = group(tree, parameters_no_osl)
tangent = tree.nodes.new("ShaderNodeTangent")
tangent.direction_type = "UV_MAP"
tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
cases = []
t, identity = (1.6, .7, .8), (1, 0, 1)
for roughness, tension, stretch, rotation, shear, strength, response in (
    (.5, identity, 0, 0, 0, 1, 0), (.45, t, 0, 0, 0, 1, 0), (.45, t, .3, .6, .4, 1.5, 0),
    (.45, t, -.5, .6, -.4, .5, 1), (.45, t, .3, .6, .4, 0, -.5), (.9, (3, .2, .4), 0, 0, 0, 1, 0),
    (.5, identity, .9, 2, 0, 1, 0), (.3, (1, 2, 1), 0, 0, 0, 2, 2), (0, t, .3, 0, 0, 1, 0),
    (.5, (0, 0, 0), 0, 0, 0, 1, 0), (.5, (-1, 0, 1), 0, 0, 0, 1, 0),
    (.5, (np.inf, 0, 1), 0, 0, 0, 1, 0), (.5, (1, np.nan, 1), 0, 0, 0, 1, 0),
    (.5, (1e30, 1e30, 1e30), 0, 0, 0, 1, 0)):
    for name, value in (("Roughness", roughness), ("Tension", tension), ("Stretch", stretch),
                        ("Rotation", rotation), ("Shear", shear), ("Strength", strength),
                        ("Height Response", response)):
        node.inputs[name].default_value = value
    got = {socket.name: show_value(socket) for socket in node.outputs}
    if not np.isfinite(tension).all() or min(tension[::2]) <= 0 or max(tension) > 1e9:
        tension = identity
    m = strengthened(tension, strength) @ material_matrix(stretch, rotation, shear)
    heights = (tension[0] * tension[2]) ** (-strength * response)
    ax, ay, angle = lobe(max(roughness, 1e-5)**2, m, heights)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    squared = turn @ np.diag([ax * ax, ay * ay]) @ turn.T
    bx, by = min(ax, 1), min(ay, 1)
    cases.append((
        {"Alpha X": ax, "Alpha Y": ay, "Roughness": (bx * by)**.25,
         "Anisotropy": 1 - (bx / by)**.5, "Anisotropic": min(1, (1 - bx / by) / .9)},
        got, [c, s], [squared[0, 0], squared[0, 1], squared[1, 1]]))
report(cases=cases)
"""
    )
    for numbers, got, smooth, squared in result["cases"]:
        for name, value in numbers.items():
            # Those of the alphas' ratio lose the digits that 1 minus the ratio cancels.
            assert np.isclose(got[name][0], value, rtol=3e-6, atol=2e-6), (name, value, got)
        size = max(squared)
        assert np.allclose(got["Alpha Squared"], squared, atol=3e-6 * size), (squared, got)
        if numbers["Anisotropy"] > 1e-6:
            across = [-smooth[1], smooth[0]]
            for name, direction in (("Tangent", smooth), ("Principled Tangent", across)):
                assert abs(np.dot(got[name][:2], direction)) > 1 - 1e-6, (name, got)
        for name in ("Tangent", "Principled Tangent"):
            assert np.isclose(np.linalg.norm(got[name]), 1, atol=1e-6), (name, got)


def test_one_lobe_equals_the_shader():
    """On both sides, of a mirrored object too, with and without Normal and Tangent."""
    result = run(
        PRELUDE
        + """
cycles(32, 32, samples=4)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)],
                  [(0, 0), (1, 0), (1, 1), (0, 1)])
light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "AREA"))
light.data.energy, light.data.size = 60, 1.0
bpy.context.scene.collection.objects.link(light)
tree, output = material(obj)
twins = group(tree, glossy), group(tree, glossy_no_osl)
tangent = tree.nodes.new("ShaderNodeTangent")
tangent.direction_type = "UV_MAP"
bump = tree.nodes.new("ShaderNodeNormalMap")
bump.inputs["Color"].default_value = (.6, .45, .9, 1)

cases = []
plain = {"Roughness": .45, "Tail": 2.0, "Tension": (1, 0, 1), "Stretch": 0.0, "Rotation": 0.0}
tense = {"Roughness": .45, "Tension": (1.6, .7, .8), "Stretch": .3, "Rotation": .6, "Shear": .4}
exact = {"Roughness": .3, "Roughness Is Alpha": True, "Strength": 1.5, "Height Response": .5}
for name, inputs, linked in (("plain", plain, ()), ("tense", tense, ("Tangent",)),
                             ("normal", exact, ("Tangent", "Normal"))):
    for node in twins:
        for key, value in inputs.items():
            node.inputs[key].default_value = value
        for key in linked:
            tree.links.new((tangent if key == "Tangent" else bump).outputs[0], node.inputs[key])
    for side in (1, -1):
        for mirror in (1, -1):
            obj.scale = (1, 1.3 * mirror, 1)
            light.location = (0.4, -1.2, 1.5 * side)
            light.rotation_euler = (0, 0, 0) if side > 0 else (np.pi, 0, 0)
            camera((0.8, 1.5, 1.4 * side), ortho_scale=2.4)
            pictures = []
            for node, osl in zip(twins, (True, False)):
                bpy.context.scene.cycles.shading_system = osl
                tree.links.new(node.outputs[0], output.inputs["Surface"])
                pictures.append(render()[..., :3])
            cases.append((f"{name} {side} {mirror}", np.abs(pictures[0] - pictures[1]).max(),
                          pictures[0].max()))
report(cases=cases)
"""
    )
    for name, error, brightest in result["cases"]:
        assert brightest > 0.05, name
        assert error < 1e-5 * max(1, brightest), (name, error, brightest)


def p22(alpha, gamma, u):
    """GTR's slope distribution, microsurface-transformations eq. 32."""
    a2 = alpha**2
    scale = 1 / -np.log(a2) if gamma == 1 else (gamma - 1) / (a2 ** (1 - gamma) - 1)
    return (1 - a2) * scale / np.pi * (1 + u) ** (gamma - 2) * (u + a2) ** -gamma


def test_lobes_add_up_to_gtr():
    """The curves cost at most 1.5 % over the fit of the table."""
    result = run(
        PRELUDE
        + """
from blender_addon.nodes.node_math import Scalar, Vector
cycles(4, 4, samples=1, osl=False)
obj = affine_quad(np.eye(2))
camera((0, 0, 3), ortho_scale=1)
tree, output = material(obj)
alpha, tail = (tree.nodes.new("ShaderNodeValue").outputs[0] for _ in range(2))
cases = []
below, beyond = (.3, 1, 1.4, 1.9), (2.2, 3, 4)
for count, alphas, tails in ((3, (.6, .25, .1), below), (5, (.04, .01), below),
                             (5, (.6, .1, .01), beyond)):
    lobes = gtr_lobes.lobes(Scalar(tree, alpha), Scalar(tree, tail), count, tails is beyond)
    for a in alphas:
        for t in tails:
            alpha.default_value, tail.default_value = a, t
            cases.append((a, t, [(kind, *show_value(Vector.of(size, weight).value)[:2])
                                 for kind, size, weight in lobes]))
report(cases=cases)
"""
    )
    for alpha, gamma, lobes in result["cases"]:
        u = np.exp(np.linspace(2 * np.log(alpha) - 9, 16, 800))
        exact = p22(alpha, gamma, u)
        u, exact = (values[u * exact > 1e-3 * (u * exact).max()] for values in (u, exact))
        got = 0
        for kind, size, weight in lobes:
            ratio = u / size**2
            density = (1 + ratio) ** -2 if kind == "GGX" else np.exp(-ratio)
            got = got + weight * density / (np.pi * size**2)
        got /= sum(weight for _kind, _size, weight in lobes)
        error = np.abs(got / exact - 1).max()
        fit = ltmd.fit_lobes(alpha, gamma, len(lobes)).max_relative_error
        assert error < fit + 0.015, (alpha, gamma, error, fit)


LIT = (
    PRELUDE
    + """
scene = cycles(48, 48, samples=4)
bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16)
obj = bpy.context.object
bpy.ops.object.shade_smooth()
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
scene.collection.objects.link(sun)
sun.data.angle = 0  # only evaluated: no noise
sun.data.energy = 3
camera((0, -4, 1), ortho_scale=2.3)
tree, output = material(obj)
tangent = tree.nodes.new("ShaderNodeTangent")

base = tree.nodes.new("ShaderNodeBsdfDiffuse")
base.inputs["Color"].default_value = (.6, .2, .1, 1)

def picture(module, inputs, osl):
    node = group(tree, module)
    tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
    if "Base" in node.inputs:
        tree.links.new(base.outputs[0], node.inputs["Base"])
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    scene.cycles.shading_system = osl
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    lit = []
    for place in ((.3, -.3, 0), (1.2, 0, .9), (2.2, 0, 3.6)):  # in front, aside, behind
        sun.rotation_euler = place
        lit.append(render()[..., :3])
    return sum(lit)
"""
)


def flip(reference, picture):
    from flip_evaluator import evaluate

    return evaluate(np.array(reference, np.float32), np.array(picture, np.float32), "HDR")[1]


def compare_pictures(cases):
    """cases: [name of the group's module, inputs]."""
    result = run(
        LIT
        + """
report(pairs=[[picture(module, case, osl) for module, osl in zip(pair(name), (True, False))]
              for name, case in ARGUMENTS])
""",
        arguments=cases,
        timeout=600,
    )
    for case, (reference, got) in zip(cases, result["pairs"], strict=True):
        assert np.mean(reference) > 0.02, case
        assert flip(reference, got) < 0.01, (case, flip(reference, got))


def test_lobes_look_like_the_shaders():
    compare_pictures(
        [
            ["glossy", {"Roughness": 0.4, "Tail": 1.4, "Tension": (1.3, 0.2, 0.9)}],
            ["glossy", {"Roughness": 0.15, "Tail": 0.7}],
            ["conductor", {"Roughness": 0.4, "Tail": 3.0, "Conductor Type": 1}],
            ["dielectric", {"Roughness": 0.4, "Tail": 1.4, "Tension": (1.3, 0.2, 0.9)}],
        ]
    )


@pytest.mark.long
def test_lobes_look_like_the_shaders_at_many_tails():
    tails = (0.5, 1.2, 1.7, 1.9, 2.2, 2.5, 3.5)
    compare_pictures(
        [
            [kind, {"Roughness": r, "Tail": t}]
            for kind in ("glossy", "conductor", "dielectric")
            for r in (0.15, 0.35, 0.7)
            for t in tails
        ]
    )


def test_sources_give_what_the_shaders_give():
    """On an object of uneven scale that is mirrored; smooth normals turn only the tangent."""
    result = run(
        PRELUDE
        + """
cycles(20, 20, samples=1)
bpy.ops.mesh.primitive_torus_add(major_segments=24, minor_segments=12)
obj = bpy.context.object
obj.scale = (1, -1.5, .8)
n = len(obj.data.vertices)
random = np.random.default_rng(0)
stretch = np.eye(3) + .3 * random.standard_normal((n, 3, 3))
tensor = stretch @ stretch.transpose(0, 2, 1)
for name, values in (
    ("ltmd_tension", np.c_[random.uniform(.6, 1.5, n), random.normal(0, .3, n),
                           random.uniform(.6, 1.5, n)]),
    ("ltmd_tensor_diagonal", tensor[:, [0, 1, 2], [0, 1, 2]]),
    ("ltmd_tensor_off_diagonal", tensor[:, [0, 0, 1], [1, 2, 2]])):
    attribute = obj.data.attributes.new(name, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", values.astype(np.float32).ravel())
camera((1, -3, 2.5), ortho_scale=3)
tree, output = material(obj)
uv, image = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeCombineColor")
place = tree.nodes.new("ShaderNodeSeparateXYZ")
image.inputs["Red"].default_value = 1.5
tree.links.new(uv.outputs[0], place.inputs[0])
tree.links.new(place.outputs[0], image.inputs["Green"])
tree.links.new(place.outputs[1], image.inputs["Blue"])
above = tree.nodes.new("ShaderNodeVectorMath")  # a picture has no negative values
above.inputs[1].default_value = (9, 9, 9)

def seen(socket):
    tree.links.new(socket, above.inputs[0])
    show(tree, output, above.outputs[0])
    picture = render()[..., :3]
    return picture[picture[..., 0] > 1] - 9

def values(module, osl):
    bpy.context.scene.cycles.shading_system = osl
    node = group(tree, module)
    tree.links.new(uv.outputs[0], node.inputs["UV"])
    if "Image" in node.inputs:
        tree.links.new(image.outputs[0], node.inputs["Image"])
        node.inputs["Previous"].default_value = (1, .5, 2)
        node.inputs["Tile"].default_value = ARGUMENTS
    tangent = seen(node.outputs["Tangent"])
    normal = seen(tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"])
    tangent = tangent - normal * (tangent * normal).sum(1, keepdims=True)
    return seen(node.outputs["Tension"]), tangent / np.linalg.norm(tangent, axis=1, keepdims=True)

cases = []
for smooth in (False, True):
    (bpy.ops.object.shade_smooth if smooth else bpy.ops.object.shade_flat)()
    for name in ("attribute_tension", "texture_tension", "tensor_tension"):
        (t, x), (t2, x2) = (values(m, osl) for m, osl in zip(pair(name), (True, False)))
        turned = np.degrees(np.arccos(np.clip(abs((x * x2).sum(1)), 0, 1)))
        cases.append((name, smooth, np.abs(t - t2).max(), t.std(), np.median(turned), turned.max()))
report(cases=cases)
""",
        arguments=1001,
    )
    for name, smooth, error, spread, median, most in result["cases"]:
        assert spread > 0.1, name
        if not (smooth and name == "tensor_tension"):  # that one's frame is the tangent's
            assert error < 1e-5, (name, error)
        assert most < (15 if smooth else 0.05), (name, most)  # faces meet at 15 and 30 degrees
        assert median < (4 if smooth else 0.01), (name, median)
