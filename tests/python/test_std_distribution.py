# SPDX-License-Identifier: Apache-2.0
"""STD and Phong, whose masking is exact."""

import ltmd
import numpy as np
import pytest
import scipy.integrate
import scipy.special

A = np.geomspace(1e-3, 1e3, 200)
GAMMAS = [1.51, 1.7, 2.0, 2.5, 4.0, 10.0, 40.0, 1e3]


def view(a, alpha=1.0):
    """Views with 1 / (alpha tan(theta)) = a."""
    v = np.stack([np.ones_like(a), np.zeros_like(a), alpha * a], axis=-1)
    return v / np.hypot(1, alpha * a)[..., None]


def beckmann_mixture(a, gamma):
    """Lambda of Beckmann lobes whose 1 / alpha^2 follow Gamma(gamma - 1) / (gamma - 1)."""
    k = gamma - 1

    def weighted(t):
        c = a * np.sqrt(t / k)
        lobe = np.exp(-(c**2)) / (2 * np.sqrt(np.pi) * c) - scipy.special.erfc(c) / 2
        return lobe * np.exp((k - 1) * np.log(t) - t - scipy.special.gammaln(k))

    pieces = [0, 1e-9, 1e-5, 1e-2, 0.3, 1, 3, 10, 30, 90]
    if k > 10:
        pieces = k + np.sqrt(k) * np.linspace(-min(10, np.sqrt(k)), 12, 12)
    return sum(
        scipy.integrate.quad(weighted, low, high, epsabs=0, epsrel=1e-12, limit=200)[0]
        for low, high in zip(pieces[:-1], pieces[1:], strict=True)
    )


@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize("a", [0.05, 0.7, 2.0])
def test_lambda_is_that_of_the_mixture_of_beckmann_lobes(gamma, a):
    # For gamma near 3/2 the lobes of the smallest rates are out of the quadrature's reach.
    tolerance = 1e-10 if gamma > 1.6 else 1e-6
    given = ltmd.STD(0.3, gamma).Lambda(view(np.array(a), 0.3))
    assert 1 + given == pytest.approx(1 + beckmann_mixture(a, gamma), rel=tolerance)


def test_gamma_2_is_ggx(rng):
    m = ltmd.GGX(0.2).sample(rng.random((1000, 2)))
    ours, ggx = ltmd.STD(0.2, 2.0), ltmd.GGX(0.2)
    for function in ("D", "Lambda", "G1", "projected_area"):
        np.testing.assert_allclose(
            getattr(ours, function)(m), getattr(ggx, function)(m), rtol=1e-12, atol=1e-15
        )


def test_gamma_to_infinity_is_beckmann():
    ours, beckmann = ltmd.STD(0.4, 1e7), ltmd.Beckmann(0.4)
    v = view(A)
    np.testing.assert_allclose(ours.G1(v), beckmann.G1(v), rtol=1e-7)
    m = view(np.linspace(0.7, 30, 50))  # up to slopes of 3.6 alpha
    np.testing.assert_allclose(ours.D(m), beckmann.D(m), rtol=3.6**4 * 1e-7)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize("degrees", [0, 45, 80, 89.9])
def test_visible_slopes_invert_their_distribution(dtype, gamma, degrees, rng):
    """The share of visible slopes below the sample's is the random number it came from."""
    alpha, k = 0.5, gamma - 1
    theta = np.radians(degrees)
    v = np.array([np.sin(theta), 0, np.cos(theta)], dtype=dtype)
    resolution = np.finfo(dtype).eps
    u = np.concatenate(
        [rng.random(5000), np.geomspace(1e-5, 1, 100), 1 - np.geomspace(resolution, 1, 100)]
    ).astype(dtype)
    m = ltmd.STD(alpha, gamma).sample_visible(v, np.stack([u, np.full_like(u, 0.3)], axis=1))
    m, v, u = m.astype(float), v.astype(float), u.astype(float)
    x, y = -m[:, :2].T / m[:, 2] / alpha / np.sqrt(k)
    p, q = v[2], alpha * np.sqrt(k) * v[0]

    def tail(x, k):
        half = scipy.special.betaincc(0.5, k, x**2 / (1 + x**2)) / 2
        return np.where(x > 0, half, 1 - half)

    def below(x):
        moment = np.exp((0.5 - k) * np.log1p(x**2)) / (2 * k - 1) / scipy.special.beta(k, 0.5)
        return p * (1 - tail(x, k)) + q * moment

    share = below(x) / (below(p / q) if q > 0 else p)
    allowed = 100 * resolution
    if dtype == np.float64:
        # The integrals are fitted to 1e-13; the last billionths and steep slopes converge slower.
        allowed = 1e-12 + 1e-8 * ((u > 1 - 1e-6) | (np.abs(x) > 1e4))
    # Steeper slopes than 1e11, most of them at grazing angles for gamma near 3/2, are horizontal.
    told = x > -1e11
    assert np.all((np.abs(share - u) <= allowed)[told])
    assert np.all(u[~told] <= below(-9e10) / (below(p / q) if q > 0 else p))
    across = 1 - tail(y / np.sqrt(1 + x**2), k + 0.5)
    np.testing.assert_allclose(across, np.float64(dtype(0.3)), atol=100 * resolution)


@pytest.mark.parametrize("exponent", [0, 1, 20, 1e4])
def test_phong_is_a_power_of_the_cosine(exponent):
    cosine = np.linspace(0.05, 1, 50)
    m = np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], axis=1)
    expected = (exponent + 2) / (2 * np.pi) * cosine**exponent
    kept = expected > 1e-250
    given = ltmd.Phong(exponent).D(m)
    np.testing.assert_allclose(given[kept], expected[kept], rtol=1e-13 * (exponent + 10))


def masking_error(given, exact):
    return np.abs((1 + exact) / (1 + given) - 1).max()


@pytest.mark.parametrize(
    ("gamma", "error"), [(1.6, 0.00364), (2.0, 0.00696), (3.0, 0.00513), (40.0, 0.00505)]
)
def test_the_published_masking_of_std_is_off(gamma, error):
    exact = ltmd.STD(1.0, gamma).Lambda(view(A))
    given = ltmd.std_lambda_rational(A, gamma)
    assert masking_error(given, exact) == pytest.approx(error, rel=0.02)


@pytest.mark.parametrize(
    ("exponent", "error"), [(0, 0.766), (1, 0.378), (10, 0.0655), (100, 0.00913)]
)
def test_the_usual_masking_of_phong_is_off(exponent, error):
    alpha = np.sqrt(2 / (exponent + 2))
    exact = ltmd.Phong(exponent).Lambda(view(A, alpha))
    given = ltmd.beckmann_lambda_rational(A)
    assert masking_error(given, exact) == pytest.approx(error, rel=0.02)


def test_refusals_name_the_value_and_the_range():
    for alpha in (0, -1, 1e-7, 1e7, np.nan):
        with pytest.raises(ValueError, match="alpha"):
            ltmd.STD(alpha, 3.0)
    for gamma in (1.5, 0, np.nan, 1e10):
        with pytest.raises(ValueError, match=r"gamma.*1\.51"):
            ltmd.STD(0.3, gamma)
    for exponent in (-0.1, np.inf, np.nan):
        with pytest.raises(ValueError, match="exponent"):
            ltmd.Phong(exponent)
