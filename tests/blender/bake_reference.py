# SPDX-License-Identifier: Apache-2.0
"""What baked texels must be, in float64, and the files as another reader sees them."""

import importlib.util
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

_PYTHON_TESTS = Path(__file__).resolve().parents[1] / "python"


def _load(name):
    spec = importlib.util.spec_from_file_location(f"reference_{name}", _PYTHON_TESTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


model = _load("model")

# A texel whose centre is this near to an edge, in texels, may belong to either side.
EDGE = 0.01


def read(path):
    """float32[height, width, 4], row 0 = top."""
    source = oiio.ImageInput.open(str(path))
    assert source is not None, f"{path}: {oiio.geterror()}"
    assert list(source.spec().channelnames) == ["R", "G", "B", "A"]
    pixels = source.read_image("float")
    source.close()
    return pixels


def metadata(path):
    source = oiio.ImageInput.open(str(path))
    return {a.name: a.value for a in source.spec().extra_attribs if a.name.startswith("ltmd:")}


def corner_tension(rest, deformed):
    """float64[corners, 3] in the metric of the deformed state's object."""
    matrix = np.asarray(deformed["matrix"], float)
    return model.tension(
        rest["triangles"],
        rest["corner_vert"],
        rest["corner_uv"],
        len(rest["positions"]),
        np.asarray(rest["positions"], float) @ matrix.T,
        np.asarray(deformed["positions"], float) @ matrix.T,
    )


def texels(rest, corner_values, size, tile=(0, 0)):
    """(mask, values): texels whose centre is inside exactly one triangle, and what they hold."""
    values = np.zeros((size, size, 3))
    hits = np.zeros((size, size), int)
    uv = np.asarray(rest["corner_uv"], float) - tile
    points = np.stack([uv[:, 0] * size, (1 - uv[:, 1]) * size], axis=1)
    for corners in np.asarray(rest["triangles"]):
        a, b, c = points[corners]
        low = np.maximum(np.floor(np.min([a, b, c], axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(np.max([a, b, c], axis=0)).astype(int), size)
        edges = np.stack([b - a, c - a], axis=1)
        area = np.linalg.det(edges)
        if (high <= low).any() or area == 0:
            continue
        x, y = np.meshgrid(*(np.arange(low[i], high[i]) + 0.5 for i in range(2)))
        t = np.linalg.inv(edges) @ (np.stack([x.ravel(), y.ravel()]) - a[:, None])
        weights = np.stack([1 - t[0] - t[1], t[0], t[1]], axis=1)
        # Height over each edge, in texels.
        lengths = [np.linalg.norm(p - q) for p, q in ((b, c), (c, a), (a, b))]
        heights = weights * abs(area) / np.array(lengths)
        near = (heights > -EDGE).all(axis=1)
        inside = (heights > EDGE).all(axis=1)
        rows, columns = (np.floor(y.ravel()).astype(int), np.floor(x.ravel()).astype(int))
        # A centre near an edge counts twice, so it is not judged.
        hits[rows[near], columns[near]] += 2
        hits[rows[inside], columns[inside]] -= 1
        values[rows[inside], columns[inside]] = weights[inside] @ corner_values[corners]
    return hits == 1, values


# The inputs are the same float32 positions, so only the arithmetic differs.
TOLERANCE = 1e-6


def rounded_tolerance(rest):
    """Where positions are rounded on the way: their rounding against the shortest edge."""
    p = np.asarray(rest["positions"], float)[np.asarray(rest["corner_vert"])[rest["triangles"]]]
    shortest = np.linalg.norm(p - np.roll(p, 1, axis=1), axis=2).min()
    return 2 * np.finfo(np.float32).eps * np.abs(p).max() / shortest
