# SPDX-License-Identifier: Apache-2.0
"""What several languages must agree on: docs/contract.md says it, the others are held to it."""

import ast
import importlib.util
import itertools
import json
import pathlib
import re
import typing

import ltmd
import meshes
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONTRACT = (ROOT / "docs/contract.md").read_text()


def text(path):
    return (ROOT / path).read_text()


def find(pattern, path):
    """The first group of the one or more matches, which must not differ."""
    found = set(re.findall(pattern, text(path)))
    assert len(found) == 1, f"{path}: {pattern} finds {found or 'nothing'}"
    return found.pop()


def sources(*patterns):
    return [p for pattern in patterns for p in sorted(ROOT.glob(pattern))]


def table(first_heading):
    """Rows of the contract's table whose first column has this heading, as lists of cells."""
    body = CONTRACT.split(f"\n| {first_heading} |", 1)[1].split("\n\n")[0]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in body.split("\n")[2:]]


def names(cell):
    return re.findall(r"`([^`]+)`", cell)


def naming():
    """blender_addon/naming.py, which needs no Blender."""
    spec = importlib.util.spec_from_file_location("naming", ROOT / "blender_addon/naming.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def assigned(path, name):
    """The literal that a Python module assigns to a name."""
    for node in ast.walk(ast.parse(text(path))):
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == name:
            return ast.literal_eval(node.value)
    pytest.fail(f"{path} assigns no {name}")


def test_convention():
    number = int(re.search(r"covers `ltmd:convention` \*\*(\d+)\*\*", CONTRACT)[1])
    assert number == ltmd.convention
    assert number == int(find(r"int convention = (\d+);", "cpp/include/ltmd/exr.h"))
    assert number == int(assigned("blender_addon/bake.py", "CONVENTION"))
    assert number == json.loads(text("docs/samples/expected.json"))["convention"]


def test_identity():
    said = re.search(r"The undeformed state is \*\*\(([^)]+)\)\*\*", CONTRACT)[1]
    assert said == "1, 0, 1"
    header = find(r"identity_tension = \{([^}]+)\}", "cpp/include/ltmd/tension.h")
    assert header.replace(".0f", "") == said
    defaults = re.compile(
        r"(?:\b(?:Tension|Image|Previous) = (?:vector|color)|return vector)\(([^)]+)\)"
    )
    shaders = [
        m for p in sources("osl/**/*.osl", "osl/**/*.h") for m in defaults.findall(p.read_text())
    ]
    assert len(shaders) >= 5
    assert {value for value in shaders if "," in value and value[0].isdigit()} == {said}
    # Group inputs: name, type, tooltip, default.
    inputs = re.compile(
        r'tree,\s*"(?:Tension|Image|Previous)",\s*"(?:Vector|Color)",(?:\s*"[^"]*")+,\s*\(([^)]+)\)'
    )
    groups = [m for p in sources("blender_addon/nodes/*.py") for m in inputs.findall(p.read_text())]
    assert len(groups) >= 4
    assert {", ".join(str(int(float(v))) for v in g.split(",")[:3]) for g in groups} == {said}
    assert set(
        re.findall(
            r"background: Sequence\[float\] = \(([^)]+)\)", text("cpp/python/ltmd/_ltmd.pyi")
        )
    ) == {"1.0, 0.0, 1.0"}
    shape = meshes.grid(2, 2)
    assert (shape.tension(shape.positions) == [1, 0, 1]).all()


def test_bounds_of_stretch():
    low, high = (
        float(v) for v in re.search(r"stretches lie in \[([\d.]+), ([\d.]+)\]", CONTRACT).groups()
    )
    assert low == float(find(r"min_stretch = ([\de.-]+);", "cpp/src/vector_math.h"))
    assert high == float(find(r"max_stretch = ([\de.-]+);", "cpp/src/vector_math.h"))
    assert f"[{low:g}, {high:g}]".replace("0.001", "1e-3").replace("1000", "1e3") in text(
        "osl/include/ltmd_tension.h"
    )
    # There on squared stretches.
    squares = set(
        re.findall(
            r"clamp\((?:largest|smallest), ([\de.-]+), ([\de.-]+)\)",
            text("osl/include/ltmd_tension.h"),
        )
    )
    assert {(float(a), float(b)) for a, b in squares} == {(low**2, high**2)}
    shape = meshes.grid(1, 1)
    for factor, bound in ((1e-6, low), (1e6, high)):
        t = shape.tension((shape.positions * factor).astype(np.float32))
        np.testing.assert_allclose(t, np.tile([bound, 0, bound], (len(t), 1)), rtol=1e-6)


def test_pass_names_and_what_they_hold_undeformed(tmp_path):
    rows = {names(row[0])[0]: row for row in table("pass")}
    assert list(rows) == list(ltmd.passes)
    offered = assigned("blender_addon/properties.py", "PASS_ITEMS")
    assert [item[0].lower() for item in offered] == list(rows)
    shape = meshes.grid(2, 2)
    mesh = shape.mesh()
    # A tile that no face reaches is all undeformed; half the faces of the mesh's own are.
    for tile in ((0, 0), (5, 5)):
        with ltmd.SequenceBaker(mesh, shape.rest(mesh), 8, 8, list(rows), tile=tile) as baker:
            baker.frame(shape.positions, {name: tmp_path / f"{name}.exr" for name in rows})
        for name, (_, _, undeformed) in rows.items():
            pixels = ltmd.read_exr(tmp_path / f"{name}.exr")
            assert pixels.shape == (8, 8, 4) and (pixels == pixels[0, 0]).all(), name
            if undeformed[0].isdigit():
                assert pixels[0, 0].tolist() == [float(v) for v in undeformed.split(",")], name
            else:
                assert re.search(r"those of the lobe at rest", undeformed), name
                alpha = 0.5  # of a SequenceBaker that is given no lobe
                expected = {"alpha2": [alpha**2, 0, alpha**2, 1], "roughness": [alpha, alpha, 1, 0]}
                np.testing.assert_allclose(pixels[0, 0], expected[name], rtol=1e-6, atol=1e-7)


def test_metadata_keys():
    said = {key for row in table("key") for key in names(row[0])}
    assert len(said) >= 12
    used = {}
    literal = re.compile(r"[\"'](ltmd:[a-z0-9_]+)[\"']")
    for path in sources(
        "cpp/**/*.cpp", "cpp/**/*.h", "blender_addon/**/*.py", "docs/**/*.py", "examples/*.py"
    ):
        for key in literal.findall(path.read_text()):
            used.setdefault(key, path.name)
    assert set(used) <= said, {key: used[key] for key in set(used) - said}
    assert said <= set(used), f"{said - set(used)} stand in the contract only"


def test_metadata_that_every_baked_file_has(tmp_path):
    shape = meshes.grid(2, 2)
    mesh = shape.mesh()
    with ltmd.SequenceBaker(mesh, shape.rest(mesh), 8, 8) as baker:
        baker.frame(shape.positions, {"tension": tmp_path / "a_tension.0001.exr"})
    keys = {k for k in ltmd.exr_metadata(tmp_path / "a_tension.0001.exr") if k.startswith("ltmd:")}
    assert {"ltmd:convention", "ltmd:pass", "ltmd:per", "ltmd:udim", "ltmd:version"} <= keys
    assert keys <= {key for row in table("key") for key in names(row[0])}
    per = next(row[1] for row in table("key") if row[0] == "`ltmd:per`")
    assert set(names(per)) == set(typing.get_args(stub_alias("Per")))


def stub_alias(name):
    """A Literal[…] of the package's stubs."""
    code = find(
        rf"^{name} = (Literal\[.*\])$".replace("^", "(?m:^)").replace("$", "(?m:$)"),
        "cpp/python/ltmd/_ltmd.pyi",
    )
    return eval(code, {"Literal": typing.Literal})


def test_codecs():
    said = re.search(r"Codecs are lossless \(([^)]+)\)", CONTRACT)[1].lower().split(", ")
    assert set(said) == set(typing.get_args(stub_alias("Compression")))
    assert set(said) == set(assigned("blender_addon/bake.py", "COMPRESSIONS"))


def test_default_margin():
    said = re.search(r"The margin \((\d+) texels unless", CONTRACT)[1]
    assert (
        find(r"Tile tile = \{\}, int margin = (\d+)\)", "cpp/include/ltmd/texel_coverage.h") == said
    )
    assert find(r"int margin = (\d+);", "cpp/include/ltmd/sequence_baker.h") == said
    for path in ("cpp/bindings/bind_texel_coverage.cpp", "cpp/bindings/bind_sequence_baker.cpp"):
        assert find(r'"margin"_a = (\d+)', path) == said
    assert find(r"margin: int = (\d+)", "cpp/python/ltmd/_ltmd.pyi") == said
    assert find(r"margin: int = (\d+)", "blender_addon/bake.py") == said
    assert find(r"margin: IntProperty\([^)]*?default=(\d+)", "blender_addon/properties.py") == said
    assert find(r'"--margin"[^)]*default=(\d+)', "blender_addon/command.py") == said


def test_largest_margin():
    """What the panel offers is what the library takes."""
    most = find(r"margin 0 to (\d+) texels", "cpp/include/ltmd/texel_coverage.h")
    for path in ("properties.py", "bake.py"):
        assert find(r"margin: IntProperty\([^)]*?max=(\d+)", f"blender_addon/{path}") == most
    assert find(r"a margin is 0 to (\d+) pixels", "blender_addon/command.py") == most
    assert find(r"isdigit\(\) or int\(text\) > (\d+):", "blender_addon/command.py") == most
    mesh = meshes.grid(1, 1).mesh()
    ltmd.TexelCoverage(mesh, 8, 8, margin=int(most))
    with pytest.raises(ValueError, match=most):
        ltmd.TexelCoverage(mesh, 8, 8, margin=int(most) + 1)


def test_file_names(tmp_path):
    """The extension's names are the contract's, and the ones that verify finds."""
    patterns = re.findall(r"DIR/(<object>_<pass>\S*)\.exr", CONTRACT)
    assert patterns == ["<object>_<pass>.<frame>", "<object>_<pass>.<udim>.<frame>"]
    assert "0007; -007 before 0" in CONTRACT
    module = naming()
    for frame, tile in itertools.product((7, -7, 0, 12345), (None, (0, 0), (3, 2))):
        digits = {7: "0007", -7: "-007", 0: "0000", 12345: "12345"}[frame]
        number = None if tile is None else 1001 + tile[0] + 10 * tile[1]
        stem = patterns[tile is not None].replace("<object>", "Ball").replace("<pass>", "tension")
        expected = stem.replace("<udim>", str(number)).replace("<frame>", digits) + ".exr"
        assert module.file_name("Ball", "tension", frame, tile) == expected
        if tile is not None:
            assert module.udim(tile) == ltmd.udim(tile) == number
        folder = tmp_path / expected
        folder.mkdir()
        pixels = np.full((4, 4, 3), (1, 0, 1), np.float32)
        metadata = {"ltmd:convention": ltmd.convention, "ltmd:frame": frame, "ltmd:pass": "tension"}
        ltmd.write_exr(folder / expected, pixels, metadata=metadata)
        report = ltmd.verify(folder)
        assert report.ok, report.problems
        assert report.sequences == {expected[: -len(f".{digits}.exr")]: [frame]}


def test_udim_formula():
    assert "udim = 1001 + u + 10 v" in CONTRACT
    assert "(Tile - 1001)" in text("docs/samples/read_tension.osl")
    assert "int number = Tile - 1001;" in text("osl/ltmd_tension_texture.osl")


def test_attribute_names():
    said = {names(row[0])[0] for row in table("name")}
    assert assigned("blender_addon/nodes/rest_positions.py", "REST_ATTRIBUTE") in said
    assert assigned("blender_addon/usd.py", "PRIMVAR") in said
    attribute = re.compile(r"[\"'](ltmd_(?:rest|tension|tensor)(?:_(?:off_)?diagonal)?)[\"']")
    for path in sources("blender_addon/**/*.py"):
        # The shaders' names are no attributes.
        found = set(attribute.findall(path.read_text()))
        assert found <= said, f"{path.name}: {found - said}"
