# SPDX-License-Identifier: Apache-2.0
"""The energy that one reflection leaves behind: equations 102-105 of masking-shadowing."""

import ltmd
import numpy as np
import pytest
from microfacet import MATRICES, direction
from test_masking import directions
from test_microfacet_brdf import hemisphere

MODELS = ["separable", "height_correlated", "height_direction_correlated", "v_cavity"]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("angle", [0.1, 0.9, 1.4])
def test_albedo_is_the_integral_of_the_brdf(model, angle):
    d = ltmd.GGX(0.7)
    wo = direction(angle)
    wi, weight = hemisphere()
    expected = np.sum(ltmd.brdf(d, wi, wo, model=model) * weight)
    albedo = ltmd.single_scattering_albedo(d, wo, model, points=128)
    assert albedo == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("matrix", ["identity", "stretch"])
def test_white_furnace_of_both_terms(matrix):
    """eq. 103."""
    d = ltmd.GGX(0.8).transformed(MATRICES[matrix])
    rest = ltmd.MultipleScattering(d, points=24)
    wi, weight = hemisphere(1, 48)
    for angle in (0.1, 0.9, 1.4):
        wo = direction(angle)
        both = ltmd.brdf(d, wi, wo) + rest.brdf(wi, wo)
        assert np.sum(both * weight) == pytest.approx(1, abs=3e-3)
        assert rest.energy(wo) == 1 - ltmd.single_scattering_albedo(d, wo, points=24)


def test_reciprocity_and_range(rng):
    rest = ltmd.MultipleScattering(ltmd.GGX(0.8, 0.2), points=16)
    a, b = directions(rng, 50), directions(rng, 50)
    np.testing.assert_allclose(rest.brdf(a, b), rest.brdf(b, a), rtol=1e-14)
    energy = rest.energy(a)
    assert 0 <= energy.min() and energy.max() <= 1
    assert 0 < rest.mean_energy < 1
    assert rest.energy(-a[0]) == 0
    assert rest.brdf(a[0], -b[0]) == 0
    single = rest.brdf(a.astype(np.float32), b.astype(np.float32))
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, rest.brdf(a, b), rtol=1e-3)


def test_smooth_surfaces_scatter_once():
    rest = ltmd.MultipleScattering(ltmd.GGX(1e-4))
    assert rest.mean_energy < 1e-3
    assert rest.energy(direction(0.5)) < 1e-3


def test_average_visible_fresnel():
    """eq. 105 against an integral over the visible normals' density."""
    d = ltmd.GGX(0.5)
    wo = direction(1.0)
    m, weight = hemisphere(1, 400)
    f = ltmd.fresnel_schlick(np.clip(m @ wo, 0, 1), 0.04)
    expected = np.sum(f * d.pdf_visible(wo, m) * weight / m[..., 2])
    result = ltmd.average_visible_fresnel(
        d, wo, lambda c: ltmd.fresnel_schlick(c, 0.04), points=128
    )
    assert result == pytest.approx(expected, rel=1e-3)
    smooth = ltmd.average_visible_fresnel(
        ltmd.GGX(1e-5), np.stack([wo, wo]), lambda c: ltmd.fresnel_schlick(c, 0.04)
    )
    np.testing.assert_allclose(smooth, ltmd.fresnel_schlick(wo[2], 0.04), rtol=1e-3)
