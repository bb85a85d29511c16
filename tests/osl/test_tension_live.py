# SPDX-License-Identifier: Apache-2.0
"""Live tension against a float64 model of T = D R^-1, per pixel."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
from mathutils import Matrix
"""
TOLERANCE = 1e-5


def close(result):
    """Every case in the child's report: per-pixel values against the expected ones."""
    assert result["cases"]
    for case in result["cases"]:
        got = np.array(case["pixels"])[..., :3].reshape(-1, 3)
        error = np.abs(got - np.array(case["expected"])).max()
        assert error < case.get("tolerance", TOLERANCE), (case["name"], error, got[0])


AFFINE = (
    PRELUDE
    + """
cases = []
cycles(8, 8)
view = camera((0, 0, 3), ortho_scale=0.5)
def scene(name, A, uv, matrix=Matrix(), attribute=True, back=False, linked_uv=True):
    bpy.data.objects.remove(bpy.data.objects["Quad"]) if "Quad" in bpy.data.objects else None
    obj = affine_quad(A, uv, attribute)
    obj.matrix_world = matrix
    view.location.z = -3 if back else 3
    view.rotation_euler = (np.pi, 0, 0) if back else (0, 0, 0)
    tree, output = material(obj)
    tension = group(tree, live_tension)
    if linked_uv:
        map = tree.nodes.new("ShaderNodeUVMap")
        tree.links.new(map.outputs[0], tension.inputs["UV"])
    world = np.array(matrix)[:3, :3]
    rest = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0)]) @ world.T
    moved = np.c_[np.array([(-1, -1), (1, -1), (1, 1)]) @ np.array(A).T, [0, 0, 0]] @ world.T
    t, tangent = tension_model(rest, moved, np.array(uv)[:3])
    for socket, expected in (("Tension", t), ("Tangent", tangent)):
        show(tree, output, tension.outputs[socket])
        cases.append(dict(name=f"{name} {socket}", pixels=render(), expected=expected))
    return tension, tree, output
UV = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
TURNED = UV @ np.array([[.3, .5], [-.6, .2]])
MIRRORED = UV * (-1, 1)
A = [[1.7, 0.6], [0.2, 0.8]]
B = [[0.5, -0.9], [0.3, 1.1]]
"""
)


def test_affine_plane_equals_the_analytic_tension():
    close(
        run(
            AFFINE
            + """
for attribute in (True, False):
    for back in (False, True):
        for label, uv in (("plain", UV), ("turned", TURNED), ("mirrored", MIRRORED)):
            for A_, letter in ((A, "A"), (B, "B")):
                scene(f"{label} {letter} attribute={attribute} back={back}", A_, uv,
                      attribute=attribute, back=back)
report(cases=cases)
"""
        )
    )


def test_object_scale_is_not_stretch_and_a_mirrored_object_keeps_its_side():
    close(
        run(
            AFFINE
            + """
identity = [[1, 0], [0, 1]]
for label, matrix in (
    ("scaled", Matrix.Diagonal((3, 0.5, 2, 1))),
    ("turned", Matrix.Rotation(0.7, 4, "Z") @ Matrix.Diagonal((2, 0.7, 1, 1))),
    ("negative", Matrix.Diagonal((-1.5, 0.8, 1, 1))),
):
    for back in (False, True):
        for deform_label, A_ in (("rest", identity), ("deformed", A)):
            scene(f"{label} {deform_label} back={back}", A_, TURNED, matrix=matrix, back=back)
report(cases=cases)
"""
        )
    )


def test_random_triangles_in_space():
    close(
        run(
            PRELUDE
            + """
rng = np.random.default_rng(0)
cycles(4, 4)
cases = []
uv = rng.random((6, 3, 2))
for index in range(6):
    rest = rng.normal(size=(3, 3))
    moved = rng.normal(size=(3, 3))
    obj = mesh_object(f"T{index}", rest, [(0, 1, 2)], uv[index])
    deform(obj, moved)
    attribute = obj.data.attributes.new("ltmd_rest", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", rest.astype(np.float32).ravel())
    normal = np.cross(moved[1] - moved[0], moved[2] - moved[0])
    normal /= np.linalg.norm(normal)
    centre = moved.mean(axis=0)
    tree, output = material(obj)
    tension = group(tree, live_tension)
    map = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(map.outputs[0], tension.inputs["UV"])
    expected, tangent = tension_model(rest, moved, uv[index])
    for side in (1, -1):
        # Oblique, so that no screen axis is special.
        camera(centre + side * 2 * normal + 0.7 * (moved[1] - moved[0]), centre, ortho_scale=0.01)
        for socket, value in (("Tension", expected), ("Tangent", tangent)):
            show(tree, output, tension.outputs[socket])
            cases.append(dict(name=f"{index} {side} {socket}", pixels=render(), expected=value,
                              # Slender triangles amplify the rounding of float.
                              tolerance=5e-5 * max(1, np.abs(value).max())))
    bpy.data.objects.remove(obj)
report(cases=cases)
"""
        )
    )


def test_without_a_uv_map_the_stretches_are_right():
    result = run(
        AFFINE
        + """
out = []
for linked in (True, False):
    for back in (False, True):
        bpy.data.objects.remove(bpy.data.objects["Quad"]) if "Quad" in bpy.data.objects else None
        obj = affine_quad(A, None)
        view.location.z = -3 if back else 3
        view.rotation_euler = (np.pi, 0, 0) if back else (0, 0, 0)
        tree, output = material(obj)
        tension = group(tree, live_tension)
        if linked:
            map = tree.nodes.new("ShaderNodeUVMap")
            tree.links.new(map.outputs[0], tension.inputs["UV"])
        values = {}
        for socket in ("Tension", "Tangent"):
            show(tree, output, tension.outputs[socket])
            values[socket] = render()[4, 4, :3]
        out.append(values)
report(out=out, A=A)
"""
    )
    a = np.array(result["A"])
    for values in result["out"]:
        t11, t12, t22 = values["Tension"]
        x = np.array(values["Tangent"])[:2]
        frame = np.array([x, [-x[1], x[0]]]).T  # the plane's own side, from both faces
        t = np.array([[t11, t12], [0, t22]])
        assert np.abs(frame @ t @ t.T @ frame.T - a @ a.T).max() < 1e-5


def test_degenerate_gives_the_rest_state():
    result = run(
        AFFINE
        + """
out = {}
# No rest area: the rest attribute puts all points on a line.
obj = affine_quad(A, UV)
flat = np.array([(-1, 0, 0), (1, 0, 0), (1, 0, 0), (-1, 0, 0)], np.float32)
obj.data.attributes["ltmd_rest"].data.foreach_set("vector", flat.ravel())
tree, output = material(obj)
tension = group(tree, live_tension)
map = tree.nodes.new("ShaderNodeUVMap")
tree.links.new(map.outputs[0], tension.inputs["UV"])
show(tree, output, tension.outputs["Tension"])
out["rest without area"] = render()
flat[2:, 1] = 1e-8  # nearly none
obj.data.attributes["ltmd_rest"].data.foreach_set("vector", flat.ravel())
obj.data.update()
out["rest with hardly any area"] = render()
# A UV map without area: the stretches are still those of the surface.
obj.data.attributes["ltmd_rest"].data.foreach_set(
    "vector", np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32).ravel())
obj.data.uv_layers[0].uv.foreach_set("vector", np.zeros(8, np.float32))
obj.data.shape_keys.key_blocks[1].value = 0
out["uv without area at rest"] = render()
report(out=out)
"""
    )
    for name, pixels in result["out"].items():
        assert np.abs(np.array(pixels)[..., :3] - (1, 0, 1)).max() < 1e-5, name


def test_extreme_stretch_is_bounded_as_the_library_bounds_it():
    result = run(
        AFFINE
        + """
scene("long", [[5000, 0], [0, 1]], UV)
view.data.ortho_scale = 1e-5
scene("thin", [[1, 0], [0, 0.0001]], UV)
report(long=cases[0]["pixels"], thin=cases[2]["pixels"])
"""
    )
    assert np.allclose(np.array(result["long"])[..., :3], (1e3, 0, 1), rtol=1e-4, atol=1e-2)
    # Cycles' barycentric coordinates lose digits on a strip 2e-4 wide.
    assert np.allclose(np.array(result["thin"])[..., :3], (1, 0, 1e-3), rtol=1e-3, atol=1e-5)
