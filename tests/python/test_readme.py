# SPDX-License-Identifier: Apache-2.0
"""The README's Python example is the tested file, and gives what its comments promise."""

import pathlib
import re
import runpy

import ltmd
import numpy as np

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


def test_every_file_the_readme_links_to_is_there():

    for link in re.findall(r"\]\(([^)#:]+)\)", (ROOT / "README.md").read_text()):
        assert (ROOT / link).exists(), link
