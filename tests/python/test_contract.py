# SPDX-License-Identifier: Apache-2.0
"""The contract page: its samples are what its script makes, and every reader gets their numbers.

The readers in the other languages are run as they are printed: GLSL here on Mesa's CPU driver, OSL
in tests/osl/test_contract_osl.py.
"""

import json
import pathlib
import re
import runpy

import ltmd
import moderngl
import numpy as np
import OpenEXR
import pytest
from tolerance import assert_same_bits

DOCS = pathlib.Path(__file__).parents[2] / "docs"
SAMPLES = DOCS / "samples"
EXPECTED = json.loads((SAMPLES / "expected.json").read_text())
POINTS = EXPECTED["points"]
FILES = sorted(p.name for p in SAMPLES.glob("*.exr"))


def local_uv(point):
    """The point's UV within the tile of its file."""
    parts = point["file"].split(".")
    number = int(parts[1]) - 1001 if len(parts) == 4 else 0
    return point["uv"][0] - number % 10, point["uv"][1] - number // 10


def pixels(name):
    """R, G, B, A of a sample by the OpenEXR wheel, row 0 = top."""
    with OpenEXR.File(str(SAMPLES / name), separate_channels=True) as file:
        channels = file.channels()
        assert all(channels[c].pixels.dtype == np.float32 for c in "RGBA")
        return np.stack([channels[c].pixels for c in "RGBA"], axis=2)


def read(image, u, v):
    """Bilinear between texel centres, as the contract says, in float64."""
    height, width, _ = image.shape
    x, y = u * width - 0.5, (1 - v) * height - 0.5
    i, j = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - i, y - j
    columns, rows = np.clip([i, i + 1], 0, width - 1), np.clip([j, j + 1], 0, height - 1)
    block = image[np.ix_(rows, columns)].astype(float)
    return np.einsum("y,x,yxc->c", [1 - fy, fy], [1 - fx, fx], block)


def lobe(t, alpha, m0):
    """The contract's formulas, in float64."""
    m = np.array([[t[0], t[1]], [0, t[2]]]) @ np.array(m0)
    sigma = np.linalg.inv(m).T @ np.diag(np.square(alpha)) @ np.linalg.inv(m)
    spread = np.hypot((sigma[0, 0] - sigma[1, 1]) / 2, sigma[0, 1])
    largest = sigma.trace() / 2 + spread
    smallest = np.linalg.det(sigma) / largest
    if spread <= 1e-6 * largest:
        return np.sqrt(largest), np.sqrt(largest), 0.0
    angle = (np.arctan2(2 * sigma[0, 1], sigma[0, 0] - sigma[1, 1]) + np.pi) / 2
    return np.sqrt(smallest), np.sqrt(largest), angle % np.pi


def assert_lobes(actual, expected, tolerance):
    """Alphas relative, angles modulo pi."""
    actual, expected = np.asarray(actual, float), np.asarray(expected, float)
    np.testing.assert_allclose(actual[:, :2], expected[:, :2], rtol=tolerance)
    turn = (actual[:, 2] - expected[:, 2] + np.pi / 2) % np.pi - np.pi / 2
    assert np.abs(turn).max() < tolerance
    assert (actual[:, 2] >= 0).all() and (actual[:, 2] < np.float32(np.pi)).all()


def cases():
    return [(point, case) for point in POINTS for case in point["lobes"]]


def test_the_samples_are_what_the_script_makes(tmp_path):
    runpy.run_path(str(SAMPLES / "make.py"))["main"](tmp_path)
    assert sorted(p.name for p in tmp_path.glob("*.exr")) == FILES
    for name in FILES:
        assert_same_bits(ltmd.read_exr(tmp_path / name), ltmd.read_exr(SAMPLES / name))
        made, kept = (ltmd.exr_metadata(folder / name) for folder in (tmp_path, SAMPLES))
        assert {**made, "ltmd:version": ""} == {**kept, "ltmd:version": ""}
    made = json.loads((tmp_path / "expected.json").read_text())
    for new, old in zip(made["passes"], EXPECTED["passes"], strict=True):
        assert new["file"] == old["file"] and np.allclose(new["values"], old["values"], rtol=1e-9)
    assert made["convention"] == EXPECTED["convention"] == ltmd.convention
    for new, old in zip(made["points"], POINTS, strict=True):
        assert new["file"] == old["file"] and np.allclose(new["uv"], old["uv"], rtol=1e-12)
        assert np.allclose(new["tension"], old["tension"], rtol=1e-12, atol=1e-15)
        assert_lobes(*([case["lobe"] for case in p["lobes"]] for p in (new, old)), 1e-12)


def test_the_samples_are_small_and_whole():
    assert sum((SAMPLES / name).stat().st_size for name in FILES) < 50_000
    assert ltmd.verify(SAMPLES).problems == []
    # Each expected point is in a sample, and each sample has points.
    assert sorted({point["file"] for point in POINTS + EXPECTED["passes"]}) == FILES


def test_a_float64_reader_gives_the_expected_numbers():
    images = {name: pixels(name) for name in FILES}
    for point in EXPECTED["passes"]:
        values = read(images[point["file"]], *local_uv(point))
        np.testing.assert_allclose(values, point["values"], rtol=1e-6, atol=1e-6)
    for point in POINTS:
        t = read(images[point["file"]], *local_uv(point))[:3]
        np.testing.assert_allclose(t, point["tension"], rtol=1e-6, atol=1e-6)
    actual = [lobe(read(images[p["file"]], *local_uv(p)), c["alpha"], c["m0"]) for p, c in cases()]
    assert_lobes(actual, [c["lobe"] for _, c in cases()], 1e-5)


@pytest.fixture(scope="module")
def gpu():
    # Mesa's EGL and its CPU driver serve where there is no display.
    with moderngl.create_context(
        standalone=True, backend="egl", libegl="libEGL.so.1", libgl="libGL.so.1"
    ) as context:
        context.simple_framebuffer((1, 1)).use()  # nothing is drawn, but GL asks for one
        yield context


def run_glsl(gpu, image, uv, alpha, m0):
    """The printed GLSL, run per vertex: tension and lobe of each case."""
    program = gpu.program(
        vertex_shader="#version 330\n"
        + (SAMPLES / "read_tension.glsl").read_text()
        + """
        uniform sampler2D image;
        in vec2 uv, alpha;
        in vec4 m0;
        out vec3 tension, lobe;
        void main() {
            tension = ltmd_read_tension(image, uv);
            lobe = ltmd_lobe(tension, alpha, mat2(m0.xy, m0.zw));
        }""",
        varyings=["tension", "lobe"],
    )
    height, width, channels = image.shape
    texture = gpu.texture((width, height), channels, image.tobytes(), dtype="f4")
    # A reader must not depend on the sampler's filter.
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.use(0)
    columns = np.swapaxes(np.asarray(m0, np.float32), 1, 2).reshape(-1, 4)
    rows = np.concatenate([np.asarray(uv), np.asarray(alpha), columns], axis=1, dtype=np.float32)
    vertices = gpu.buffer(rows.tobytes())
    out = gpu.buffer(reserve=24 * len(rows))
    array = gpu.vertex_array(program, [(vertices, "2f 2f 4f", "uv", "alpha", "m0")])
    array.transform(out, moderngl.POINTS)
    result = np.frombuffer(out.read(), np.float32).reshape(-1, 2, 3)
    return result[:, 0], result[:, 1]


def test_the_glsl_reader_gives_the_expected_numbers(gpu):
    for name in sorted({point["file"] for point in POINTS}):
        found = [(point, case) for point, case in cases() if point["file"] == name]
        tension, lobes = run_glsl(
            gpu,
            pixels(name),
            [local_uv(point) for point, _ in found],
            [case["alpha"] for _, case in found],
            [case["m0"] for _, case in found],
        )
        expected = [point["tension"] for point, _ in found]
        np.testing.assert_allclose(tension, expected, rtol=1e-5, atol=1e-5)
        assert_lobes(lobes, [case["lobe"] for _, case in found], 1e-5)


def test_the_glsl_reader_takes_a_broken_texel_as_undeformed(gpu):
    for broken in ((np.nan, 0, 1), (1, np.inf, 1), (0, 0, 1), (1, 0, -1)):
        image = np.full((4, 4, 3), broken, np.float32)
        tension, lobes = run_glsl(gpu, image, [(0.5, 0.5)], [(0.2, 0.2)], [np.eye(2)])
        np.testing.assert_array_equal(tension, [(1, 0, 1)])
        np.testing.assert_allclose(lobes, [(0.2, 0.2, 0)], rtol=1e-6)


def test_the_readers_stay_short():
    for name in ("read_tension.glsl", "read_tension.osl"):
        lines = (SAMPLES / name).read_text().splitlines()
        code = [line for line in lines if line.strip() and not line.strip().startswith("//")]
        assert len(code) <= 40, f"{name}: {len(code)} lines of code"
        assert name in (DOCS / "contract.md").read_text()


def test_every_file_the_contract_links_to_is_there():
    text = (DOCS / "contract.md").read_text()
    for link in re.findall(r"\]\(([^)#:]+)\)", text):
        assert (DOCS / link).exists(), link
