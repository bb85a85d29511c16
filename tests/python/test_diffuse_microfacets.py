# SPDX-License-Identifier: Apache-2.0
"""Lambertian microfacets: equations 31 and 37 of masking-shadowing."""

import ltmd
import numpy as np
import pytest
from microfacet import MATRICES, direction, facing_area
from test_masking import CONSERVES_THE_VISIBLE_AREA, directions
from test_microfacet_brdf import hemisphere

PHYSICAL = [m for m, conserves in CONSERVES_THE_VISIBLE_AREA.items() if conserves]


class Lit:
    """The integrand of eq. 31 without <wo,m>."""

    def __init__(self, d, wi, wo, model):
        self.d, self.wi, self.wo, self.model = d, wi, wo, model

    def D(self, m):
        g = ltmd.G2(self.d, self.wi, self.wo, m, self.model)
        return self.d.D(m) * np.maximum(0, m @ self.wi) * g


@pytest.mark.parametrize("model", PHYSICAL)
@pytest.mark.parametrize("matrix", ["identity", "shear"])
def test_is_the_integral_over_normals(model, matrix):
    M = MATRICES[matrix]
    d = ltmd.Beckmann(0.5).transformed(M)
    wi, wo = direction(1.2, 2.5), direction(0.7)
    area = facing_area(Lit(d, wi, wo, model), wo, 0.5, M, azimuths=384)
    expected = area / (np.pi * wi[2] * wo[2])
    assert ltmd.diffuse_brdf(d, wi, wo, model, points=128) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("model", CONSERVES_THE_VISIBLE_AREA)
@pytest.mark.parametrize("angle", [0.2, 1.3])
def test_weak_white_furnace(model, angle):
    """Table 3's column for eq. 37; of mirrors it is in test_masking.py."""
    d = ltmd.GGX(0.6)
    wo = direction(angle)
    above, weight = hemisphere(1, 48)
    below, _ = hemisphere(-1, 48)
    weight = weight / above[..., 2]
    total = sum(
        np.sum(ltmd.diffuse_weak_furnace(d, w, wo, model, points=64) * weight)
        for w in (above, below)
    )
    if CONSERVES_THE_VISIBLE_AREA[model]:
        assert total == pytest.approx(1, abs=3e-3)
    elif angle > 1:
        assert abs(total - 1) > 0.015


@pytest.mark.parametrize("model", PHYSICAL)
def test_energy_and_reciprocity(model, rng):
    d = ltmd.GGX(0.8, 0.3)
    wi, weight = hemisphere(1, 32)
    for angle in (0.1, 1.0, 1.5):
        value = ltmd.diffuse_brdf(d, wi, direction(angle), model, points=16)
        assert 0.3 < np.sum(value * weight) < 1
    a, b = directions(rng, 50), directions(rng, 50)
    np.testing.assert_allclose(
        ltmd.diffuse_brdf(d, a, b, model), ltmd.diffuse_brdf(d, b, a, model), rtol=1e-12
    )


def test_smooth_limit_is_lambertian():
    value = ltmd.diffuse_brdf(ltmd.GGX(1e-5), direction(0.4), direction(1.2, 3.0))
    assert value == pytest.approx(1 / np.pi, rel=1e-3)


def test_degenerate_directions_and_refusals():
    d = ltmd.GGX(0.5)
    up, horizon = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    for wi, wo in ((up, -up), (-up, up), (horizon, up), (up, horizon)):
        assert ltmd.diffuse_brdf(d, wi, wo) == 0
    single = ltmd.diffuse_brdf(d, up.astype(np.float32), up.astype(np.float32))
    assert single.dtype == np.float32
    assert single == pytest.approx(float(ltmd.diffuse_brdf(d, up, up)), rel=1e-5)
    with pytest.raises(ValueError, match="points"):
        ltmd.diffuse_brdf(d, up, up, points=0)
