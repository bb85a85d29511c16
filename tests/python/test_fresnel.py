# SPDX-License-Identifier: Apache-2.0
"""Reflectances against Mitsuba's, closed forms and complex arithmetic."""

import ltmd
import numpy as np
import pytest

COSINES = np.linspace(0, 1, 101)
METALS = {"gold, red": (0.143, 3.98), "copper, blue": (1.14, 2.40), "k = 0": (1.5, 0.0)}


@pytest.fixture(scope="module")
def mitsuba():
    module = pytest.importorskip("mitsuba")
    module.set_variant("scalar_rgb")
    return module


@pytest.mark.parametrize("eta", [1.5, 1 / 1.5, 1.05, 2.4, 1.0])
def test_dielectric_agrees_with_mitsuba(mitsuba, eta):
    cosines = np.concatenate([-COSINES[::-1], COSINES[1:]])
    expected = [mitsuba.fresnel(float(c), eta)[0] for c in cosines]
    # Mitsuba is in float32, whose error grows where the refracted cosine vanishes.
    np.testing.assert_allclose(ltmd.fresnel_dielectric(cosines, eta), expected, atol=1e-5)


@pytest.mark.parametrize("metal", METALS)
def test_conductor_agrees_with_mitsuba(mitsuba, metal):
    index = complex(*METALS[metal])
    expected = [
        mitsuba.fresnel_conductor(float(c), mitsuba.Complex2f(index.real, index.imag))
        for c in COSINES
    ]
    np.testing.assert_allclose(
        ltmd.fresnel_conductor(COSINES, index.real, index.imag), expected, atol=2e-6
    )


@pytest.mark.parametrize("metal", METALS)
def test_conductor_is_fresnels_equations_in_complex_numbers(metal):
    index = complex(*METALS[metal])
    refracted = np.sqrt(1 - (1 - COSINES**2) / index**2 + 0j)
    s = (COSINES - index * refracted) / (COSINES + index * refracted)
    p = (index * COSINES - refracted) / (index * COSINES + refracted)
    expected = (abs(s) ** 2 + abs(p) ** 2) / 2
    result = ltmd.fresnel_conductor(COSINES, index.real, index.imag)
    np.testing.assert_allclose(result, expected, rtol=1e-12)
    single = ltmd.fresnel_conductor(COSINES.astype(np.float32), index.real, index.imag)
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, expected, rtol=1e-5)


def test_known_values():
    assert ltmd.fresnel_dielectric(1, 1.5) == pytest.approx(0.04, rel=1e-14)
    assert ltmd.fresnel_dielectric(-1, 1.5) == pytest.approx(0.04, rel=1e-14)
    assert ltmd.fresnel_dielectric(0, 1.5) == 1
    # Brewster's angle leaves the perpendicular part, ((1 - n^2) / (1 + n^2))^2 / 2.
    brewster = np.cos(np.arctan(1.5))
    expected = ((1 - 1.5**2) / (1 + 1.5**2)) ** 2 / 2
    assert ltmd.fresnel_dielectric(brewster, 1.5) == pytest.approx(expected, rel=1e-13)
    assert ltmd.fresnel_schlick(1, 0.04) == 0.04
    assert ltmd.fresnel_schlick(0, 0.04) == 1
    assert ltmd.fresnel_conductor(0, 0.2, 3.9) == 1
    assert ltmd.fresnel_conductor(0, 1, 0) == 0


def test_total_internal_reflection_begins_at_the_critical_angle():
    critical = np.sqrt(1 - 1 / 1.5**2)
    inside = -np.linspace(0, 1, 1001)
    total = ltmd.fresnel_dielectric(inside, 1.5) == 1
    np.testing.assert_array_equal(total, -inside <= critical)


def test_a_ray_and_the_ray_it_refracts_to_reflect_alike():
    cosines = np.linspace(0.01, 1, 100)
    refracted = np.sqrt(1 - (1 - cosines**2) / 1.5**2)
    np.testing.assert_allclose(
        ltmd.fresnel_dielectric(-refracted, 1.5), ltmd.fresnel_dielectric(cosines, 1.5), rtol=1e-12
    )


def test_edge_tint():
    f0 = np.array([0.9, 0.6, 0.3])
    tint = np.array([0.9, 0.7, 0.2])
    edge = ltmd.fresnel_schlick(1 / 7, f0)
    np.testing.assert_allclose(ltmd.fresnel_f82(1 / 7, f0, tint), tint * edge, rtol=1e-13)
    np.testing.assert_array_equal(ltmd.fresnel_f82(1, f0, tint), f0)
    np.testing.assert_array_equal(ltmd.fresnel_f82(0, f0, tint), 1)
    cosines = COSINES[:, None]
    np.testing.assert_array_equal(
        ltmd.fresnel_f82(cosines, f0, 1), ltmd.fresnel_schlick(cosines, f0)
    )
    assert ltmd.fresnel_f82(cosines, 0, 0).min() == 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_all_of_the_range_is_in_0_to_1(rng, dtype):
    count = 100_000
    cosine = rng.uniform(-1, 1, count).astype(dtype)
    cosine[:3] = 0, 1, -1
    eta = (10 ** rng.uniform(-3, 3, count)).astype(dtype)
    k = (10 ** rng.uniform(-6, 3, count)).astype(dtype)
    k[::7] = 0
    f0, tint = rng.random((2, count), dtype=dtype)
    for value in (
        ltmd.fresnel_dielectric(cosine, eta),
        ltmd.fresnel_conductor(cosine, eta, k),
        ltmd.fresnel_schlick(cosine, f0),
        ltmd.fresnel_f82(cosine, f0, tint),
    ):
        assert value.dtype == dtype
        assert value.min() >= 0
        assert value.max() <= 1 + 4 * np.finfo(dtype).eps


def test_refusals():
    with pytest.raises(ValueError, match=r"eta .*-1"):
        ltmd.fresnel_dielectric(0.5, -1)
    with pytest.raises(ValueError, match="k "):
        ltmd.fresnel_conductor(0.5, 1.5, [0.1, -0.1])
    with pytest.raises(ValueError, match="f0"):
        ltmd.fresnel_schlick(0.5, np.nan)
    with pytest.raises(ValueError, match="tint"):
        ltmd.fresnel_f82(0.5, 0.5, 1.5)
    with pytest.raises(ValueError, match="cosine"):
        ltmd.fresnel_schlick(2, 0.5)
    with pytest.raises(ValueError, match="do not fit"):
        ltmd.fresnel_schlick(np.zeros(3), np.zeros(2))
    with pytest.raises(TypeError, match="float32"):
        ltmd.fresnel_schlick(np.zeros(3), np.zeros(3, dtype=np.float32))
