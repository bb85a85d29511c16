# SPDX-License-Identifier: Apache-2.0
"""GTR: eq. 32 and Smith's integral by quadrature, limits, published masking, samplers."""

import ltmd
import numpy as np
import pytest
import scipy.integrate
import scipy.interpolate
import scipy.stats
from microfacet import MATRICES, chi_squared, direction, panels, smallest_p

ALPHAS = (1e-4, 0.01, 0.04, 0.16, 0.5, 0.9)
GAMMAS = (0.0, 0.1, 0.5, 1.0, 1.4, 1.9, 2.0, 2.2, 3.0, 3.4, 4.0)
each_alpha = pytest.mark.parametrize("alpha", ALPHAS)
each_gamma = pytest.mark.parametrize("gamma", GAMMAS)


def published_d(alpha, gamma, tangent):
    """eq. 32 and 33; 1 + (alpha^2 - 1) cos^2 as sin^2 + alpha^2 cos^2."""
    a2 = alpha**2
    if gamma == 1:
        scale = (a2 - 1) / (np.pi * np.log(a2))
    else:
        scale = (gamma - 1) * (a2 - 1) / (np.pi * (1 - a2 ** (1 - gamma)))
    return scale * ((1 + tangent**2) / (tangent**2 + a2)) ** gamma


def smith_lambda(alpha, gamma, tangent):
    """Smith's integral over the slopes in polar form; the radius is exp(x) / tangent."""
    mu = 1 / tangent

    def integrand(x):
        r = mu * np.exp(x)
        azimuth = np.arctan(np.sqrt(np.expm1(2 * x)))  # from here on microfacets face away
        area = np.sin(azimuth) - np.cos(azimuth) * azimuth
        return 2 * r**3 / mu * published_d(alpha, gamma, r) / (1 + r**2) ** 2 * area

    # Its scales are the end, the radius alpha and the radius 1.
    edges = np.unique(np.clip([0, 0.5, np.log(alpha / mu), np.log(1 / mu), 2, 5, 45], 0, 45))
    pieces = [
        scipy.integrate.quad(integrand, *ends, epsabs=0, epsrel=1e-11, limit=200)[0]
        for ends in zip(edges[:-1], edges[1:], strict=True)
    ]
    return sum(pieces)


@each_alpha
@each_gamma
def test_d_is_eq_32(alpha, gamma):
    theta = np.array([1e-3, 0.1, 0.5, 1.0, 1.5])
    m = np.array([direction(t) for t in theta])
    expected = published_d(alpha, gamma, np.tan(theta))
    np.testing.assert_allclose(ltmd.GTR(alpha, gamma).D(m), expected, rtol=1e-12)


@each_alpha
@each_gamma
def test_lambda_is_smiths_integral(alpha, gamma):
    d = ltmd.GTR(alpha, gamma)
    for tangent in (0.1, 1.0, 10.0, 100.0, 1e4):
        expected = smith_lambda(alpha, gamma, tangent)
        assert d.Lambda(direction(np.arctan(tangent))) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("near", [0.0, 1.0, 2.0, 3.0, 4.0])
@each_alpha
def test_gamma_has_no_jump(near, alpha, rng):
    m = ltmd.GGX(0.3).sample(rng.random((100, 2)))
    u = rng.random((100, 2))
    here = ltmd.GTR(alpha, near)
    # d log D / d gamma is at most the logarithm of alpha^2, twice.
    size = 1e-9 * (2 - 4 * np.log(alpha))
    for gamma in {max(near - 1e-9, 0.0), min(near + 1e-9, 4.0)}:
        there = ltmd.GTR(alpha, gamma)
        for name, given in (("D", m), ("Lambda", m), ("sample", u)):
            np.testing.assert_allclose(
                getattr(there, name)(given), getattr(here, name)(given), rtol=10 * size, atol=1e-9
            )


@each_alpha
@pytest.mark.parametrize("gamma", [0.0, 1.0, 2.0, 3.0, 4.0])
def test_the_spline_is_exact_at_integers(alpha, gamma):
    v = np.array([direction(t) for t in (0.0, 0.3, 1.0, 1.5, 1.57)])
    exact, spline = ltmd.GTR(alpha, gamma), ltmd.GTR(alpha, gamma, masking="spline")
    np.testing.assert_allclose(spline.G1(v), exact.G1(v), rtol=1e-12)


@each_alpha
@each_gamma
def test_the_spline_is_the_natural_one_of_the_published_values(alpha, gamma):
    """Appendix A, eq. 35-39 as printed, in mu = cot(theta)."""
    theta = np.array([0.3, 1.0, 1.4, 1.55])
    mu, a2 = 1 / np.tan(theta), alpha**2
    a, b = np.sqrt(mu**2 + a2), np.sqrt(mu**2 + 1)
    a4 = 8 * alpha**4 + 8 * a2 + 8
    published = [
        2 / (1 + np.sqrt(1 / mu**2 + 1)),
        mu * np.log(a2) / (a - b + mu * np.log(a2 * (mu + b) / (mu + a))),
        2 / (1 + np.sqrt(a2 / mu**2 + 1)),
        4 * (a2 + 1) * mu * a / (a2 * (3 * a2 + 1) + 2 * mu * (a2 + 1) * (mu + a)),
        2 * a4 * mu * a**3
        / (
            a4 * mu * (a**3 + mu**3)
            + 3 * a2 * (a2 * (5 * a2**2 + 2 * a2 + 1) + 4 * mu**2 * (2 * a2**2 + a2 + 1))
        ),
    ]  # fmt: skip
    spline = scipy.interpolate.CubicSpline(range(5), published, bc_type="natural")
    d = ltmd.GTR(alpha, gamma, masking="spline")
    v = np.array([direction(t) for t in theta])
    np.testing.assert_allclose(d.G1(v), np.clip(spline(gamma), 0, 1), atol=1e-12, rtol=1e-9)


# alpha -> gamma -> least and greatest error, theta from 5 to 89 degrees in half degrees
SPLINE_FURNACE = {
    0.01: {0.5: (-0.893, 0.325), 1.5: (-0.197, 0.001), 2.2: (0.0, 0.039), 3.5: (-0.020, 0.0)},
    0.04: {0.5: (-0.440, 0.146), 1.4: (-0.088, 0.105), 2.5: (-0.002, 0.027), 3.5: (-0.011, 0.0)},
    0.16: {0.5: (-0.018, 0.033), 1.4: (-0.014, 0.025), 2.5: (-0.009, 0.005), 3.5: (-0.002, 0.001)},
}


@pytest.mark.parametrize("alpha", SPLINE_FURNACE)
def test_the_spline_breaks_the_furnace_by_this_much(alpha):
    v = np.array([direction(np.radians(t)) for t in np.arange(5, 89.1, 0.5)])
    for gamma, expected in SPLINE_FURNACE[alpha].items():
        d = ltmd.GTR(alpha, gamma, masking="spline")
        error = d.G1(v) * d.projected_area(v) / v[:, 2] - 1
        assert (error.min(), error.max()) == pytest.approx(expected, abs=6e-4)


def chi_squared_reflected(m, v, pdf, steps=(12, 24), order=16):
    """The p-value of normals against their density, by the directions above the horizon that they
    reflect v to: at the horizon the density of normals jumps."""
    light = 2 * (m @ v)[:, None] * m - v
    phi = np.arctan2(light[:, 1], light[:, 0]) % (2 * np.pi)
    edges = [np.linspace(0, end, n + 1) for end, n in zip((1, 2 * np.pi), steps, strict=True)]
    observed, _, _ = np.histogram2d(light[:, 2], phi, bins=edges)
    (z, z_weight), (phi, phi_weight) = (panels(e, order) for e in edges)
    sine = np.sqrt(1 - z**2)[:, None]
    grid = np.stack(np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), z[:, None]), -1)
    half = grid + v
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    density = pdf(half) / (4 * half @ v) * z_weight[:, None] * phi_weight
    expected = density.reshape(steps[0], order, steps[1], order).sum(axis=(1, 3)).ravel()
    expected = len(m) * np.append(expected, 1 - expected.sum())
    observed = np.append(observed.ravel(), np.sum(light[:, 2] < 0))
    many = expected > 5
    f = np.append(expected[many], expected[~many].sum())
    o = np.append(observed[many], observed[~many].sum())
    statistic = np.sum((o - f)[f > 5] ** 2 / f[f > 5])
    return scipy.stats.chi2.sf(statistic, np.sum(f > 5) - 1)


@pytest.mark.parametrize("matrix", MATRICES)
def test_bounded_normals_follow_their_density(matrix, rng):
    d, M, v = ltmd.GTR(0.04, 1.4), MATRICES[matrix], direction(1.4)
    m = d.sample_bounded(v, rng.random((400_000, 2)), M)
    assert chi_squared(m, lambda n: d.pdf_bounded(v, n, M), 0.04, M) > smallest_p(6)


@pytest.mark.parametrize("alpha, gamma", [(0.3, 0.5), (0.2, 2.0), (1.0, 1.0)])
@pytest.mark.parametrize("matrix", ["identity", "shear", "reflection"])
@pytest.mark.parametrize("angle", [0.3, 1.4])
def test_bounded_reflections_follow_their_density(alpha, gamma, matrix, angle, rng):
    d, M, v = ltmd.GTR(alpha, gamma), MATRICES[matrix], direction(angle)
    m = d.sample_bounded(v, rng.random((400_000, 2)), M)
    p = chi_squared_reflected(m, v, lambda n: d.pdf_bounded(v, n, M))
    assert p > smallest_p(18)


@pytest.mark.parametrize("alpha", [0.2, 1.0])
@pytest.mark.parametrize("gamma", [0.5, 2.2])
@pytest.mark.parametrize("angle", [0.3, 1.4])
def test_mixed_reflections_follow_their_density(alpha, gamma, angle, rng):
    d, v = ltmd.GTR(alpha, gamma), direction(angle)
    m = d.sample_mixed(v, rng.random((400_000, 2)))
    assert chi_squared_reflected(m, v, lambda n: d.pdf_mixed(v, n)) > smallest_p(8)


def reflection_weights(d, v, m, pdf):
    """Samples of the albedo of white mirrors, height-correlated (masking-shadowing, eq. 99)."""
    facing = m @ v
    light = 2 * facing[:, None] * m - v
    kept = (light[:, 2] > 0) & (facing > 0)
    out = np.zeros(len(m))
    masking = 1 / (1 + d.Lambda(v) + d.Lambda(light[kept]))
    out[kept] = d.D(m[kept]) * masking * facing[kept] / (v[2] * pdf(m[kept]))
    return out


# alpha 0.3: gamma -> variance relative to visible normals at 10 and 80 degrees
SAMPLER_VARIANCE = {
    "bounded": {0.1: (0.16, 0.32), 0.5: (0.18, 0.34), 1.0: (0.20, 0.40), 1.5: (0.22, 0.50)},
    "mixed": {0.1: (0.65, 3.2), 0.5: (0.8, 3.6), 1.0: (1.0, 4.4), 1.5: (1.34, 5.85)},
}


@pytest.mark.parametrize("gamma", SAMPLER_VARIANCE["bounded"])
@pytest.mark.parametrize("way", [0, 1])
def test_samplers_agree_and_differ_in_variance(gamma, way, rng):
    d, v = ltmd.GTR(0.3, gamma), direction(np.radians((10, 80)[way]))
    u = rng.random((200_000, 2))
    found = {}
    for name in ("visible", "bounded", "mixed"):
        m = getattr(d, f"sample_{name}")(v, u)
        w = reflection_weights(d, v, m, lambda n, name=name: getattr(d, f"pdf_{name}")(v, n))
        found[name] = w
    albedo = found["visible"].mean()
    for name in ("bounded", "mixed"):
        error = 4 * np.sqrt(found[name].var() / len(u) + found["visible"].var() / len(u))
        assert found[name].mean() == pytest.approx(albedo, abs=error)
        ratio = found[name].var() / found["visible"].var()
        expected = SAMPLER_VARIANCE[name][gamma][way]
        assert ratio == pytest.approx(expected, rel=0.15)


def test_lobes_are_the_distribution():
    slopes = np.outer(10.0 ** np.arange(-4, 3), [0.6, 0.8])
    v = np.array([direction(t) for t in (0.0, 0.5, 1.0, 1.5)])
    for alpha, gamma in ((0.01, 0.5), (0.1, 1.4), (0.7, 1.9)):
        d = ltmd.GTR(alpha, gamma)
        np.testing.assert_allclose(d.lobes.P22(slopes), d.P22(slopes), rtol=1e-9)
        np.testing.assert_allclose(d.lobes.Lambda(v), d.Lambda(v), rtol=1e-11, atol=1e-16)
    d = ltmd.GTR(0.3, 3.0)
    assert set(d.lobes.kind) == {"beckmann"}
    np.testing.assert_allclose(d.lobes.G1(v), d.G1(v), rtol=1e-5)


def test_refusals():
    for alpha in (0.0, 9e-5, 1.01, np.nan):
        with pytest.raises(ValueError, match="alpha"):
            ltmd.GTR(alpha, 1.0)
    for gamma in (-0.1, 4.1, np.inf):
        with pytest.raises(ValueError, match="gamma"):
            ltmd.GTR(0.1, gamma)
    with pytest.raises(ValueError, match="'exact' or 'spline', not 'both'"):
        ltmd.GTR(0.1, 1.0, masking="both")
    v = direction(0.3)
    with pytest.raises(ValueError, match="gamma <= 2"):
        ltmd.GTR(0.1, 2.2).sample_bounded(v, np.zeros(2))
    with pytest.raises(ValueError, match="invertible"):
        ltmd.GTR(0.1, 1.0).sample_bounded(v, np.zeros(2), [[1, 1], [1, 1]])
