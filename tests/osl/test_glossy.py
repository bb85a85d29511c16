# SPDX-License-Identifier: Apache-2.0
"""The lobe of LTMD Glossy is the stock Glossy BSDF with the equivalent alphas and tangent."""

from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
"""
    + """
cycles(48, 48, samples=4)
tree, output, view = lit_plane()
reflection = group(tree, glossy)
stock = tree.nodes.new("ShaderNodeBsdfAnisotropic")
stock.distribution = "GGX"
stock.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
reflection.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
direction = tree.nodes.new("ShaderNodeCombineXYZ")
tree.links.new(direction.outputs[0], stock.inputs["Tangent"])

def picture(node):
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return render()[..., :3]

def expected(roughness, matrix, heights=1.0):
    ax, ay, angle = lobe(roughness**2, matrix, heights)
    assert max(ax, ay) < 1
    stock.inputs["Roughness"].default_value = (ax * ay) ** 0.25
    stock.inputs["Anisotropy"].default_value = 1 - np.sqrt(ax / ay)
    direction.inputs[0].default_value = np.cos(angle)
    direction.inputs[1].default_value = np.sin(angle)
    return picture(stock)

def compare(name, **inputs):
    heights = inputs.pop("heights", 1.0)
    matrix = inputs.pop("matrix")
    for key, value in inputs.items():
        reflection.inputs[key].default_value = value
    for side in (1, -1):
        view(side)
        got, want = picture(reflection), expected(inputs["Roughness"], matrix, heights)
        cases.append(dict(name=f"{name} side {side}", error=np.abs(got - want).max(),
                          brightest=want.max(), mean=want.mean()))

def tensor(t):
    return np.array([[t[0], t[1]], [0, t[2]]])

cases = []
uv = tree.nodes.new("ShaderNodeUVMap")
tension = group(tree, live_tension)
tree.links.new(uv.outputs[0], tension.inputs["UV"])
tree.links.new(tension.outputs["Tangent"], reflection.inputs["Tangent"])
"""
)


def check(result):
    assert result["cases"]
    for case in result["cases"]:
        assert case["brightest"] > 0.1, case  # a highlight is in view
        assert case["error"] < 1e-5 * max(1, case["brightest"]), case


def test_material_anisotropy_equals_stock_glossy():
    check(
        run(
            PRELUDE
            + """
for stretch, rotation, shear in ((0, 0, 0), (.4, 0, 0), (-.3, .5, 0), (0, 0, .8), (.5, 1.1, -.6)):
    compare(f"{stretch} {rotation} {shear}", Roughness=0.45, Stretch=stretch, Rotation=rotation,
            Shear=shear, matrix=material_matrix(stretch, rotation, shear))
report(cases=cases)
"""
        )
    )


def test_tension_strength_and_height_response_equal_stock_glossy():
    check(
        run(
            PRELUDE
            + """
t = (1.6, 0.7, 0.8)
m0 = material_matrix(.3, .6, .4)
reflection.inputs["Tension"].default_value = t
compare("tension", Roughness=0.45, matrix=tensor(t))
compare("tension and material", Roughness=0.45, Stretch=.3, Rotation=.6, Shear=.4,
        matrix=tensor(t) @ m0)
for strength in (0.0, 0.5, 1.5):
    compare(f"strength {strength}", Roughness=0.45, Strength=strength,
            matrix=strengthened(t, strength) @ m0)
for response in (1.0, -0.5):
    compare(f"height response {response}", Roughness=0.45, Strength=1.0,
            **{"Height Response": response}, matrix=tensor(t) @ m0,
            heights=(t[0] * t[2]) ** -response)
report(cases=cases)
"""
        )
    )


def test_lobes_and_exact_alpha_equal_stock_glossy():
    """Tail 2 is one lobe whatever Lobes is, and Roughness can be alpha itself."""
    check(
        run(
            PRELUDE
            + """
m = material_matrix(.3, .6, 0)
for lobes in (1, 3, 6):
    compare(f"lobes {lobes}", Roughness=0.45, Stretch=.3, Rotation=.6, Lobes=lobes, matrix=m)
reflection.inputs["Roughness Is Alpha"].default_value = True
reflection.inputs["Roughness"].default_value = 0.45**2
view(1)
cases.append(dict(name="alpha", error=np.abs(picture(reflection) - expected(0.45, m)).max(),
                  brightest=1))
report(cases=cases)
"""
        )
    )


def test_guards():
    """No tangent, a meaningless tension or a zero roughness never gives a black or broken pixel."""
    result = run(
        PRELUDE
        + """
view(1)
plain = expected(0.45, np.eye(2))
reflection.inputs["Roughness"].default_value = 0.45
out = {}
for name, t in (("zero", (0, 0, 0)), ("negative", (-1, 0, 1)), ("infinite", (np.inf, 0, 1)),
                ("not a number", (np.nan, np.nan, np.nan)), ("no second", (1, 0.5, 0))):
    reflection.inputs["Tension"].default_value = t
    out[name] = np.abs(picture(reflection) - plain).max()
reflection.inputs["Tension"].default_value = (1, 0, 1)
tree.links.remove(reflection.inputs["Tangent"].links[0])
out["no tangent"] = np.abs(picture(reflection) - plain).max()
reflection.inputs["Tension"].default_value = (3, 1, 1e-9)
finite = [bool(np.isfinite(picture(reflection)).all())]
reflection.inputs["Tension"].default_value = (1e30, 1e30, 1e30)
finite.append(bool(np.isfinite(picture(reflection)).all()))
reflection.inputs["Tension"].default_value = (1, 0, 1)
reflection.inputs["Roughness"].default_value = 0
finite.append(bool(np.isfinite(picture(reflection)).all()))
report(out=out, finite=finite)
"""
    )
    for name, error in result["out"].items():
        assert error < 1e-5, (name, error)
    assert all(result["finite"])
