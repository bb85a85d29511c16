# SPDX-License-Identifier: Apache-2.0
"""Masking at a height, whose mean over heights is masking (masking-shadowing, appendix B)."""

import functools

import ltmd
import numpy as np
import pytest
from microfacet import direction

D = ltmd.GGX(0.8, 0.4)
M_UP = np.array([0.0, 0.0, 1.0])


@functools.cache
def heights(kind):
    """Nodes and weights over the distribution of heights."""
    x, w = np.polynomial.legendre.leggauss(400)
    if kind == "uniform":
        return x, w / 2
    x, w = 9 * x, 9 * w
    return x, w * np.exp(-x * x / 2) / np.sqrt(2 * np.pi)


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
@pytest.mark.parametrize("angle", [0.3, 1.0, 1.5])
def test_mean_over_heights(kind, angle):
    h, w = heights(kind)
    for v in (direction(angle), -direction(angle)):
        assert w @ ltmd.G1_at_height(D, v, M_UP, h, kind) == pytest.approx(
            ltmd.G1(D, v, M_UP), abs=1e-5
        )
        for o in (direction(1.2, 2.0), -direction(1.2, 2.0)):
            joint = w @ ltmd.G2_at_height(D, v, o, M_UP, h, kind)
            assert joint == pytest.approx(ltmd.G2(D, v, o, M_UP), abs=1e-5)


def test_heights():
    v = direction(1.4)
    exponent = D.Lambda(v)
    for h, below in ((-1, 0), (0, 0.5), (1, 1), (3, 1)):
        expected = below**exponent
        assert ltmd.G1_at_height(D, v, M_UP, h, "uniform") == pytest.approx(expected, rel=1e-14)
    gaussian = ltmd.G1_at_height(D, v, M_UP, [-1.0, 0.0, 1.0])
    np.testing.assert_allclose(
        gaussian, np.array([0.15865525393145707, 0.5, 0.8413447460685429]) ** exponent, rtol=1e-13
    )
    # High points are seen from above, low ones from below.
    assert np.all(np.diff(gaussian) > 0)
    below = ltmd.G1_at_height(D, -v, M_UP, [-1.0, 0.0, 1.0])
    np.testing.assert_allclose(below, gaussian[::-1], rtol=1e-13)


def test_away_from_the_microfacet_and_refusals():
    steep = direction(1.0, 0.0)
    assert ltmd.G1_at_height(D, direction(1.0, np.pi), steep, 1) == 0
    single = ltmd.G1_at_height(D, direction(1.0).astype(np.float32), M_UP.astype(np.float32), 0)
    assert single.dtype == np.float32
    with pytest.raises(ValueError, match="'uniform' or 'gaussian', not 'flat'"):
        ltmd.G1_at_height(D, M_UP, M_UP, 0, "flat")
