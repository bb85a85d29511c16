# SPDX-License-Identifier: Apache-2.0
import ltmd
import numpy as np
import pytest
import scipy.special

A = np.geomspace(1e-4, 25, 400)


def view(a):
    """Views at which the Lambda of Beckmann(1) is that of a = cot(theta)."""
    v = np.stack([np.ones_like(a), np.zeros_like(a), a], axis=-1)
    return v / np.hypot(1, a)[..., None]


def exact_lambda(a):
    """Lambda by its convergent continued fraction where the closed form cancels."""
    ratio = np.zeros_like(a)
    for n in range(4000, 1, -1):
        ratio = 1 / (2 * a + 2 * n * ratio)
    fraction = scipy.special.erfcx(a) * ratio
    closed = 1 / np.sqrt(np.pi) - a * scipy.special.erfcx(a)
    return np.exp(-(a**2)) * np.where(a < 0.5, closed, fraction) / (2 * a)


def test_lambda_is_exact_where_it_is_tiny_too():
    given = ltmd.Beckmann(1.0).Lambda(view(A))
    # e^(-a^2) magnifies the rounding of a by 2 a^2.
    tolerance = 1e-14 + 4 * A**2 * np.finfo(float).eps
    assert np.all(np.abs(given / exact_lambda(A) - 1) < tolerance)
    assert given[-1] < 1e-270


def test_float_lambda_is_exact_where_it_is_tiny_too():
    v = view(A[A < 9]).astype(np.float32)
    exact = ltmd.Beckmann(0.7, 1.3).Lambda(v.astype(np.float64))
    a2 = v[:, 2] ** 2 / (0.7 * v[:, 0]) ** 2
    given = ltmd.Beckmann(0.7, 1.3).Lambda(v)
    kept = exact > 1e-37
    assert np.all(
        np.abs(given / exact - 1)[kept] < (5e-7 + 4 * a2 * np.finfo(np.float32).eps)[kept]
    )


def test_the_rational_lambda_is_up_to_a_third_of_a_percent_off():
    error = (1 + ltmd.Beckmann(1.0).Lambda(view(A))) / (1 + ltmd.beckmann_lambda_rational(A)) - 1
    assert np.abs(error).max() == pytest.approx(0.00312, abs=2e-5)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("alpha", [1e-4, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("degrees", [0, 1, 45, 80, 89, 89.9])
def test_visible_slopes_invert_their_distribution(dtype, alpha, degrees, rng):
    """The share of visible slopes below the sample's is the random number it came from."""
    theta = np.radians(degrees)
    v = np.array([np.sin(theta), 0, np.cos(theta)], dtype=dtype)
    resolution = np.finfo(dtype).eps
    u = np.concatenate(
        [rng.random(20000), np.geomspace(resolution, 1, 200), 1 - np.geomspace(resolution, 1, 200)]
    ).astype(dtype)
    u = np.clip(u, resolution, 1 - resolution)
    m = ltmd.Beckmann(alpha).sample_visible(v, np.stack([u, np.full_like(u, 0.3)], axis=1))
    m, v, u = m.astype(float), v.astype(float), u.astype(float)
    x, y = -m[:, :2].T / m[:, 2] / alpha
    p, q = v[2], alpha * v[0]

    def below(x):
        bell = np.exp(-(x**2)) * q / np.sqrt(np.pi)
        return p * scipy.special.erfc(-x) + bell

    share = below(x) / below(p / q if q > 0 else np.inf)
    # Near the highest slope the share is flat, below 0 it is exact relative to itself.
    allowed = np.where(x < 0, u, 1) * resolution * (200 if dtype == np.float64 else 40)
    if dtype == np.float64:
        # Four steps reach half of the last billionth next to the highest slope.
        allowed = allowed + 1e-8 * (u > 1 - 1e-6)
    assert np.all(np.abs(share - u) <= allowed)
    np.testing.assert_allclose(
        (1 + scipy.special.erf(y)) / 2, np.float64(dtype(0.3)), rtol=40 * resolution
    )
