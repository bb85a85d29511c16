# SPDX-License-Identifier: Apache-2.0
"""Sheen: its closed forms, the Smith integral, and the published fit of it."""

import ltmd
import numpy as np
import pytest
import scipy.integrate
import scipy.stats
from microfacet import direction

ALPHAS = [1e-3, 0.01, 0.1, 0.3, 1.0]


def density(alpha, theta):
    return (2 + 1 / alpha) / (2 * np.pi) * np.sin(theta) ** (1 / alpha)


def projected_area(alpha, view):
    """The integral of D max(0, v.m) over normals, by its closed form in the azimuth."""
    c, s = np.cos(view), np.sin(view)

    def ring(theta):
        a, b = c * np.cos(theta), s * np.sin(theta)
        phi = np.arccos(-np.clip(a / b, -1, 1)) if b > 0 else np.pi
        return density(alpha, theta) * np.sin(theta) * 2 * (a * phi + b * np.sin(phi))

    edges = np.unique([0, np.pi / 2 - view, *(np.pi / 2 - 0.5 ** np.arange(12)), np.pi / 2])
    return sum(
        scipy.integrate.quad(ring, a, b, epsabs=1e-13, epsrel=1e-11)[0]
        for a, b in zip(edges[edges >= 0], edges[edges >= 0][1:], strict=False)
    )


@pytest.mark.parametrize("alpha", ALPHAS)
def test_d_is_the_power_of_the_sine(alpha):
    theta = np.linspace(0, 1.5707, 300)
    m = np.stack([direction(t, 1.1) for t in theta])
    d = ltmd.Sheen(alpha)
    # The sine of float64 normals is known to eps; the power takes it times 1 / alpha.
    tolerance = 10 * np.finfo(float).eps / alpha
    np.testing.assert_allclose(d.D(m), density(alpha, theta), rtol=tolerance, atol=1e-300)
    slopes = np.stack([np.tan(theta), 0 * theta], axis=-1)
    expected = density(alpha, theta) * np.cos(theta) ** 4
    np.testing.assert_allclose(d.P22(slopes), expected, rtol=tolerance, atol=1e-300)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_masking_is_the_smith_integral(alpha):
    d = ltmd.Sheen(alpha)
    for degrees in (0.5, 5, 20, 45, 70, 85, 89, 89.9):
        v = direction(np.radians(degrees))
        expected = projected_area(alpha, np.radians(degrees))
        assert d.projected_area(v) == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_samples_have_a_uniform_power_of_the_sine(alpha, rng):
    u = rng.random((100_000, 2))
    u[:4] = [[0, 0], [1, 1], [0, 1], [1, 0]]
    m = ltmd.Sheen(alpha).sample(u)
    assert np.all(np.isfinite(m))
    power = np.hypot(m[:, 0], m[:, 1]) ** (2 + 1 / alpha)
    np.testing.assert_allclose(power, u[:, 0], atol=1e-12)


# The largest relative error of the fit's G1 up to 85 degrees.
@pytest.mark.parametrize(
    ("alpha", "error"), [(0.01, 1.410), (0.1, 0.0177), (0.2, 0.1107), (0.3, 0.1100), (0.7, 0.0109)]
)
def test_the_published_fit_is_off_by_so_much(alpha, error):
    d = ltmd.Sheen(alpha)
    v = np.stack([direction(np.radians(degrees)) for degrees in range(1, 86)])
    off = (1 + d.Lambda(v)) / (1 + d.fitted_Lambda(v)) - 1
    assert np.abs(off).max() == pytest.approx(error, rel=0.01)
    single = d.fitted_Lambda(v.astype(np.float32))
    assert single.dtype == np.float32
    # A power of a cosine that float32 rounds.
    np.testing.assert_allclose(single, d.fitted_Lambda(v), rtol=1e-3)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_float32_is_float64_rounded(alpha, rng):
    d = ltmd.Sheen(alpha)
    v = np.stack([direction(t) for t in np.pi / 2 * rng.random(1000)]).astype(np.float32)
    u = rng.random((1000, 2), dtype=np.float32)
    full = v.astype(np.float64)
    for single, exact in ((d.D(v), d.D(full)), (d.G1(v), d.G1(full))):
        assert np.all(np.isfinite(single))
        assert np.all(single >= 0)
        # float32 logarithms, times 1 / alpha.
        np.testing.assert_allclose(single, exact, rtol=1e-6 + 5e-7 / alpha, atol=1e-30)
    np.testing.assert_allclose(d.sample(u), d.sample(u.astype(float)), atol=2e-6)
    assert np.all(d.sample_visible(v, u)[:, 2] >= 0)


@pytest.mark.parametrize("alpha", [0, -1, 9e-4, 1.01, np.nan, np.inf])
def test_refusals_name_the_range(alpha):
    with pytest.raises(ValueError, match=r"alpha is .*; it must be in \[0.001, 1\]"):
        ltmd.Sheen(alpha)
