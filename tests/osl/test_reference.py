# SPDX-License-Identifier: Apache-2.0
"""Random microfacets reflect and refract as the library's BRDF and BTDF do, integrated over the
light: every distribution, masking and map, on both sides."""

import ltmd
import numpy as np
from blender_process import ROOT, run
from directional_light import polar, seen
from tile_picture import WHITE, check, tile_means

ANGLES = (1, 25, 50, 70, 80, 85)
MAPS = ((0, 0, 0, (1, 0, 1)), (0.3, 0.7, 0.4, (1, 0, 1)), (-0.2, 0.3, 0, (1.3, 0.4, 0.8)))
MODELS = ("height_correlated", "separable", "v_cavity")


def matrix(stretch, rotation, shear, t):
    return np.array([[t[0], t[1]], [0, t[2]]]) @ ltmd.material_matrix(stretch, rotation, shear)


# Facets towards a view of the angle and case that the place tells.
PROBE = """
#include "stdcycles.h"
#include "ltmd_reference.h"

shader probe(
    float Angles[{angle_count}] = {{ {angles} }},
    float Cases[{case_count}] = {{ {cases} }},
    output color Value = 0)
{{
    float theta = radians(Angles[(int)floor(P[0])]);
    // At rest, of a map that stretches the slopes along V.
    vector view = vector(0.6 * sin(theta), 1.7 * 0.8 * sin(theta), cos(theta));
    int at = 4 * (int)floor(P[1]);
    int masking = (int)Cases[at + 1];
    LtmdDistribution d = ltmd_distribution((int)Cases[at], Cases[at + 2], Cases[at + 3]);
    float facing;
    vector q = ltmd_facing_normal(d, masking, view, 7, facing);
    Value = facing * (masking == LTMD_V_CAVITY ? min(1.0, 2 * view[2] / dot(q, view))
                                               : 1 / (1 + ltmd_lambda(d, view)));
}}
"""
# Lambda's quadrature in the shader is good to 4e-4.
TOLERANCE = 5e-4


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
    mean, error = tile_means(
        "reference",
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
        Color=WHITE,
    )
    check(mean, error, np.array(expected), rows, TOLERANCE)


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
        # Heights over the change of area are a wider map.
        t = m[3]
        d = ltmd.EllipsoidNDF.from_angles(alpha, across, *tilt).transformed(
            matrix(*m) * t[0] * t[2]
        )
        # From below a surface is what its point reflection is from above.
        side = np.sign(view[2])

        def scattered(o, d=d, v=view, s=side, k=masking):
            return ltmd.brdf(d, s * v, s * o, model=MODELS[k])

        expected.append(seen(view, scattered))
    mean, error = tile_means(
        "reference",
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
        Color=WHITE,
        **{"Height Response": 1},
    )
    check(mean, error, np.array(expected), rows, TOLERANCE)


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
    mean, error = tile_means(
        "reference",
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
        Color=WHITE,
        IOR=ior,
    )
    check(mean, error, np.array(expected), rows, TOLERANCE)


def test_metal_by_random_normals():
    """Mode 2 of LTMD Conductor: Fresnel's law at each facet."""
    views = polar(ANGLES, np.random.default_rng(0).uniform(0, 360, len(ANGLES)))
    ior, extinction = np.array((0.2, 0.9, 1.5)), np.array((3.6, 2.4, 1.9))
    d = ltmd.GTR(0.3, 1.4).transformed(matrix(*MAPS[1]))

    def metal(view, channel):
        def law(cosine):
            return ltmd.fresnel_conductor(cosine, ior[channel], extinction[channel])

        return seen(view, lambda o: ltmd.brdf(d, view, o, law))[channel]

    expected = np.array([[metal(view, channel) for channel in range(3)] for view in views])
    stretch, rotation, shear, tension = MAPS[1]
    mean, error = tile_means(
        "conductor",
        views,
        256,
        {"Roughness": np.full(len(views), 0.3)},
        Mode=2,
        Tail=1.4,
        Stretch=stretch,
        Rotation=rotation,
        Shear=shear,
        Tension=tension,
        IOR=ior.tolist(),
        Extinction=extinction.tolist(),
        **{"Conductor Type": 1},
    )
    check(mean, error, expected, ANGLES, TOLERANCE)


def test_a_coat_of_random_normals_leaves_its_base_the_rest():
    """Mode 2 of LTMD Dielectric over black shows its albedo, over white all light."""
    result = run(
        f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
import tiles
"""
        + """
from blender_addon.nodes import dielectric
tree, output = tiles.scene(ARGUMENTS, 256, {})
node = group(tree, dielectric)
base = tree.nodes.new("ShaderNodeEmission")
for name, value in (("Mode", 2), ("Roughness", 0.6), ("Tail", 1.4), ("Tension", (1.3, .4, .8))):
    node.inputs[name].default_value = value
tiles.link_attribute(tree, "x_axis", node.inputs["Tangent"])
tree.links.new(node.outputs[0], output.inputs["Surface"])
out = [tiles.measure(len(ARGUMENTS))]
tree.links.new(base.outputs[0], node.inputs["Base"])
base.inputs["Color"].default_value = (1, 1, 1, 1)
out.append(tiles.measure(len(ARGUMENTS)))
report(out=out)
""",
        arguments=polar(ANGLES, 20).tolist(),
    )
    (coat, error), (white, white_error) = np.array(result["out"])[..., 0]
    d = ltmd.GTR(0.36, 1.4).transformed(np.array([[1.3, 0.4], [0, 0.8]]))
    for view, got, sigma in zip(polar(ANGLES, 20), coat, error, strict=True):

        def glass(o, v=view):
            return ltmd.brdf(d, v, o, lambda c: ltmd.fresnel_dielectric(c, 1.5))

        assert abs(got - seen(view, glass)[0]) < 4.5 * sigma + TOLERANCE, view
    # A weight may pass 1 at grazing angles: then the base cannot take the rest back.
    assert np.all(np.abs(white - 1) < 4.5 * white_error + 0.01), white


def test_weak_white_furnace(tmp_path):
    """Without shadowing every visible microfacet reflects: the weights add up to 1."""
    angles = (0.1, 20, 45, 65, 80, 87, 89.5)
    cases = [  # distribution, masking, alpha, tail
        (0, 0, 0.02, 0.3), (0, 0, 0.3, 1.0), (0, 1, 0.8, 3.5), (0, 2, 0.2, 1.5),
        (1, 0, 0.3, 0.0), (2, 0, 0.2, 1.8), (2, 0, 0.5, 20.0), (3, 0, 0.2, 0.0),
    ]  # fmt: skip
    probe = tmp_path / "probe.osl"
    probe.write_text(
        PROBE.format(
            angle_count=len(angles),
            angles=", ".join(map(str, angles)),
            case_count=4 * len(cases),
            cases=", ".join(str(x) for case in cases for x in case),
        )
    )
    result = run(
        f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""
        + """
angles, cases = ARGUMENTS["angles"], ARGUMENTS["cases"]
# Pixels of a tile are random numbers for one angle and case.
size = 16
cycles(size * len(angles), size * len(cases), samples=64)
mesh_object("Plane", [(0, 0, 0), (len(angles), 0, 0), (len(angles), len(cases), 0),
                      (0, len(cases), 0)], [(0, 1, 2, 3)])
view = camera((len(angles) / 2, len(cases) / 2, 3), (len(angles) / 2, len(cases) / 2, 0),
              ortho_scale=max(len(angles), len(cases)))
tree, output = material(bpy.data.objects["Plane"])
probe = shader_node(tree, ARGUMENTS["probe"])
show(tree, output, probe.outputs["Value"])
picture = render()[::-1, :, 0].astype(float)
tiles = picture.reshape(len(cases), size, len(angles), size).swapaxes(1, 2)
tiles = tiles.reshape(len(cases), len(angles), -1)
report(mean=tiles.mean(axis=-1), error=tiles.std(axis=-1) / size)
""",
        arguments={"angles": angles, "cases": cases, "probe": str(probe)},
    )
    mean, error = np.array(result["mean"]), np.array(result["error"])
    z = (mean - 1) / np.hypot(error, TOLERANCE)
    worst = np.unravel_index(np.argmax(np.abs(z)), z.shape)
    assert np.abs(z).max() < 4.5, (cases[worst[0]], angles[worst[1]], mean[worst], error[worst])
