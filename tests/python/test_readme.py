# SPDX-License-Identifier: Apache-2.0
"""The README's Python example is the tested file, and what the manuals show runs."""

import pathlib
import re
import runpy
import subprocess

import ltmd
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).parents[2]


def test_the_readme_shows_the_tested_file():
    code = (ROOT / "examples/first_bake.py").read_text().split("\n", 1)[1]
    assert f"```python\n{code}```" in (ROOT / "README.md").read_text()


def test_the_first_bake(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = runpy.run_path(str(ROOT / "examples/first_bake.py"))
    np.testing.assert_allclose(names["t"], np.tile([2, 0, 0.5], (4, 1)), rtol=1e-6)
    pixels = ltmd.read_exr("square_tension.0001.exr")
    assert pixels.shape == (256, 256, 4)
    np.testing.assert_array_equal(pixels[128, 128], np.float32([2, 0, 0.5, 1]))
    assert ltmd.verify(tmp_path).ok


@pytest.mark.parametrize("page", ["README.md", "docs/distributions.md"])
def test_every_file_a_page_links_to_is_there(page):
    for link in re.findall(r"\]\(([^)#:]+)\)", (ROOT / page).read_text()):
        assert (ROOT / page).parent.joinpath(link).exists(), link


def snippets(language):
    return re.findall(
        f"```{language}\n(.*?)```", (ROOT / "docs/distributions.md").read_text(), re.DOTALL
    )


def test_the_manual_of_distributions_in_python():
    names = {}
    for code in snippets("python"):
        exec(code, names)
    d, view, m = names["d"], names["view"], names["m"]
    # Of visible normals the weight is D G1 / pdf = v_z / (v.m).
    np.testing.assert_allclose(names["weight"], view[2] / (m @ view), rtol=1e-12)
    assert d.D(m).min() > 0
    assert names["reflected"] > 0
    assert names["refracted"] > 0


def test_the_manual_of_distributions_in_cpp(tmp_path):
    """The headers alone are enough to compile against."""
    (code,) = snippets("cpp")
    includes, body = code.split("\n\n", 1)
    source = tmp_path / "manual.cpp"
    source.write_text(f"{includes}\nfloat f() {{\n{body}\nreturn density;\n}}\n")
    include = ROOT / "cpp/include"
    command = ["c++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    subprocess.run([*command, f"-I{include}", str(source)], check=True)
