# SPDX-License-Identifier: Apache-2.0
"""Random microfacets reflect and refract as the library's BRDF and BTDF do, integrated over the
light: every distribution, masking and map, on both sides."""

import ltmd
import numpy as np
from blender_process import ROOT, run
from directional_light import polar, seen

TILES = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
import tiles
"""
    + """
from blender_addon.nodes import reference
def rendered(views, samples, attributes, constants, module=reference):
    tree, output = tiles.scene(views, samples, attributes)
    node = group(tree, module)
    node.inputs["Color"].default_value = (1, 1, 1, 1)
    for name, value in constants.items():
        node.inputs[name].default_value = value
    for name in attributes:
        tiles.link_attribute(tree, name, node.inputs[name])
    tiles.link_attribute(tree, "x_axis", node.inputs["Tangent"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return tiles.measure(len(views))
mean, error = rendered(**ARGUMENTS)
report(mean=mean, error=error)
"""
)
ANGLES = (1, 25, 50, 70, 80, 85)
MAPS = ((0, 0, 0, (1, 0, 1)), (0.3, 0.7, 0.4, (1, 0, 1)), (-0.2, 0.3, 0, (1.3, 0.4, 0.8)))
MODELS = ("height_correlated", "separable", "v_cavity")


def matrix(stretch, rotation, shear, t):
    return np.array([[t[0], t[1]], [0, t[2]]]) @ ltmd.material_matrix(stretch, rotation, shear)


def render(views, samples, attributes, **constants):
    views = np.asarray(views)
    result = run(
        TILES,
        arguments={
            "views": views.tolist(),
            "samples": samples,
            "attributes": {k: np.asarray(v).tolist() for k, v in attributes.items()},
            "constants": {"Roughness Is Alpha": True, **constants},
        },
    )
    return np.array(result["mean"]), np.array(result["error"])


def check(mean, error, expected, names):
    """As many deviations as chance has: each below 4.5 sigma and their mean square near 1."""
    # Lambda's quadrature in the shader is good to 4e-4.
    z = (mean - expected) / np.hypot(error, 5e-4 * np.maximum(1, expected))
    worst = np.unravel_index(np.argmax(np.abs(z)), z.shape)
    where = (names[worst[0]], mean[worst], expected[worst], error[worst])
    assert np.abs(z).max() < 4.5, where
    assert np.mean(z**2) < 1.5


def test_reflection_equals_the_library():
    rng = np.random.default_rng(0)
    cases = [  # distribution, masking, alpha, tail
        (0, 0, 0.16, 1.4), (0, 0, 0.3, 0.5), (0, 1, 0.25, 3.3), (0, 2, 0.2, 1.0), (0, 0, 0.9, 3.0),
        (1, 0, 0.3, 0.0), (2, 0, 0.3, 1.7), (2, 2, 0.25, 4.0), (3, 0, 0.4, 0.0),
    ]  # fmt: skip
    rows = [(case, angle) for case in cases for angle in ANGLES]
    maps = [MAPS[i % 3] for i in range(len(rows))]
    views = polar([angle for _, angle in rows], rng.uniform(0, 360, len(rows)))
    expected = []
    for (case, _), m, view in zip(rows, maps, views, strict=True):
        kind, masking, alpha, tail = case
        d = (
            ltmd.GTR(alpha, tail) if kind == 0 else
            ltmd.Beckmann(alpha, alpha) if kind == 1 else
            ltmd.STD(alpha, tail) if kind == 2 else
            ltmd.Sheen(alpha)
        ).transformed(matrix(*m))  # fmt: skip
        expected.append(
            seen(view, lambda o, d=d, k=masking, v=view: ltmd.brdf(d, v, o, model=MODELS[k]))
        )
    columns = np.array([case for case, _ in rows])
    mean, error = render(
        views,
        256,
        {
            "Distribution": columns[:, 0] + 0.5,
            "Masking": columns[:, 1] + 0.5,
            "Roughness": columns[:, 2],
            "Tail": columns[:, 3],
            "Stretch": [m[0] for m in maps],
            "Rotation": [m[1] for m in maps],
            "Shear": [m[2] for m in maps],
            "Tension": [m[3] for m in maps],
        },
    )
    check(mean, error, np.array(expected), rows)


def test_tilted_ellipsoids_from_both_sides():
    rng = np.random.default_rng(0)
    cases = [  # masking, alpha, alpha across, tilt
        (0, 0.3, 0.3, (0, 0, 0)), (0, 0.3, 0.1, (0.3, -0.2, 0.5)), (1, 0.5, 0.2, (-0.5, 0.4, 0)),
    ]  # fmt: skip
    rows = [(case, angle) for case in cases for angle in (1, 30, 60, 75, 110, 140)]
    maps = [MAPS[i % 3] for i in range(len(rows))]
    views = polar([angle for _, angle in rows], rng.uniform(0, 360, len(rows)))
    expected = []
    for (case, _), m, view in zip(rows, maps, views, strict=True):
        masking, alpha, across, tilt = case
        d = ltmd.EllipsoidNDF.from_angles(alpha, across, *tilt).transformed(matrix(*m))
        # From below a surface is what its point reflection is from above.
        side = np.sign(view[2])

        def scattered(o, d=d, v=view, s=side, k=masking):
            return ltmd.brdf(d, s * v, s * o, model=MODELS[k])

        expected.append(seen(view, scattered))
    mean, error = render(
        views,
        256,
        {
            "Masking": [case[0] + 0.5 for case, _ in rows],
            "Roughness": [case[1] for case, _ in rows],
            "Roughness Across": [case[2] for case, _ in rows],
            "Tilt": [case[3] for case, _ in rows],
            "Stretch": [m[0] for m in maps],
            "Rotation": [m[1] for m in maps],
            "Shear": [m[2] for m in maps],
            "Tension": [m[3] for m in maps],
        },
        Distribution=4,
    )
    check(mean, error, np.array(expected), rows)


def test_glass_under_a_map_equals_the_library():
    rng = np.random.default_rng(0)
    cases = [  # distribution, masking, alpha, tail
        (0, 0, 0.3, 1.4), (1, 1, 0.4, 0.0), (0, 2, 0.25, 3.0),
    ]  # fmt: skip
    rows = [(case, angle) for case in cases for angle in (1, 40, 70, 100, 125, 165)]
    maps = [MAPS[i % 3] for i in range(len(rows))]
    views = polar([angle for _, angle in rows], rng.uniform(0, 360, len(rows)))
    ior = 1.4
    expected = []
    for (case, _), m, view in zip(rows, maps, views, strict=True):
        kind, masking, alpha, tail = case
        d = ltmd.Beckmann(alpha, alpha) if kind else ltmd.GTR(alpha, tail)
        d = d.transformed(matrix(*m))
        side, model = np.sign(view[2]), MODELS[masking]

        def reflected(o, d=d, v=view, s=side, model=model):
            eta = ior if s > 0 else 1 / ior
            return ltmd.brdf(
                d, s * v, s * o, lambda c: ltmd.fresnel_dielectric(c, eta), model=model
            )

        def refracted(o, d=d, v=view, model=model):
            return ltmd.btdf(d, v, o, ior, model=model)

        light = seen(view, reflected) + seen(view, refracted, order=240, below=True)
        assert light[0] <= 1 + 1e-3
        expected.append(light)
    columns = np.array([case for case, _ in rows])
    mean, error = render(
        views,
        256,
        {
            "Distribution": columns[:, 0] + 0.5,
            "Masking": columns[:, 1] + 0.5,
            "Roughness": columns[:, 2],
            "Tail": columns[:, 3],
            "Stretch": [m[0] for m in maps],
            "Rotation": [m[1] for m in maps],
            "Shear": [m[2] for m in maps],
            "Tension": [m[3] for m in maps],
        },
        Refraction=True,
        IOR=ior,
    )
    check(mean, error, np.array(expected), rows)
