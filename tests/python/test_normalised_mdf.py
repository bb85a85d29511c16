# SPDX-License-Identifier: Apache-2.0
"""Gauss, Schlick's, Sawicki's and Ashikhmin-Shirley's distributions, and the normalised column of
microfacet-distribution-conversion, Table 1, with its misprints (measured)."""

import ltmd
import numpy as np
import pytest
import scipy.integrate
import scipy.stats
from microfacet import chi_squared, direction, facing_area, smallest_p

DISTRIBUTIONS = {
    "gauss_m": (ltmd.Gauss, [1e-6, 0.01, 0.3, 0.7, 2.0]),
    "schlick_m": (ltmd.SchlickMDF, [1e-6, 0.01, 0.3, 0.7, 1.0]),
    "sawicki_n": (ltmd.SawickiDS, [0.01, 1.0, 10, 1000, 1e13]),
}
CASES = [
    pytest.param(name, value, id=f"{name} {value:g}")
    for name, (_, values) in DISTRIBUTIONS.items()
    for value in values
]


def make(name, value):
    return DISTRIBUTIONS[name][0](value)


def scale_of(name, value):
    """About the angle where the peak ends."""
    return min(1.0, np.sqrt(2 / value) if name == "sawicki_n" else value)


def integral(D, edges=(0, np.pi / 2)):
    """The integral of D(theta) cos over normals."""
    return sum(
        scipy.integrate.quad(
            lambda t: 2 * np.pi * D(t) * np.sin(t) * np.cos(t), a, b, epsabs=1e-13, limit=400
        )[0]
        for a, b in zip(edges, edges[1:], strict=False)
    )


def schlick(m, theta):
    x = np.cos(theta) + m - 1
    printed = m**3 * x / (np.pi * np.cos(theta) * (m * x**2 - x**2 + m**2) ** 2)
    return printed if x > 0 else 0.0


def gauss(m, theta):
    half = np.log(np.cos(m * np.sqrt(np.log(2))))
    return (2 * half - np.log(2)) / (2 * np.pi * half) * np.exp(-((theta / m) ** 2))


def gtr(c, gamma, theta):
    return c**2 / np.pi / (np.cos(theta) ** 2 * (c**2 - 1) + 1) ** gamma


# (Distribution of the printed form, its integral by microfacet-distribution-conversion, eq. 2.)
TABLE_1 = {
    "Beckmann": (
        lambda t: np.exp(-((np.tan(t) / 0.3) ** 2)) / (np.pi * 0.3**2 * np.cos(t) ** 4),
        ltmd.Beckmann(0.3),
        1,
    ),
    "Gauss": (lambda t: gauss(0.3, t), ltmd.Gauss(0.3), 1.017),
    "Trowbridge-Reitz": (
        lambda t: (0.3 / (np.cos(t) ** 2 * (0.3**2 - 1) + 1)) ** 2 / np.pi,
        ltmd.GGX(0.3),
        1,
    ),
    "GTR 2": (lambda t: gtr(0.3, 2, t), ltmd.GGX(0.3), 1),
    "GTR 3": (lambda t: gtr(0.3, 3, t), None, 6.06),
    "Blinn-Phong": (
        lambda t: (40 + 2) / (2 * np.pi) * np.cos(t) ** 40,
        ltmd.AshikhminShirley(40, 40),
        1,
    ),
    "Schlick": (lambda t: schlick(0.3, t), ltmd.SchlickMDF(0.3), 1),
    "Sawicki": (
        lambda t: 96 * 43 * np.cos(t) / (np.pi * (-39 * np.cos(t) + 43) ** 4),
        ltmd.SawickiDS(40),
        1,
    ),
}


@pytest.mark.parametrize("name", TABLE_1)
def test_table_1(name):
    printed, d, expected = TABLE_1[name]
    edge = np.arccos(0.7) if name == "Schlick" else np.pi / 4
    total = integral(printed, (0, edge, np.pi / 2 - 1e-9))
    # Exact, or as many digits as the erratum gives.
    assert total == pytest.approx(expected, abs=1e-9 if expected == 1 else 0.005)
    if d is not None:
        for theta in (0, 0.1, 0.4, 0.9, 1.5):
            assert d.D(direction(theta)) * total == pytest.approx(printed(theta), rel=2e-3)
            if expected == 1:
                assert d.D(direction(theta)) == pytest.approx(printed(theta), rel=1e-12)


def test_anisotropic_phong_integrates_to_one_with_n_plus_two():
    for nx, ny in ((10, 10), (1, 100), (0.01, 1000)):
        total, _ = scipy.integrate.dblquad(
            lambda theta, phi, nx=nx, ny=ny: (
                np.cos(theta) ** (nx * np.cos(phi) ** 2 + ny * np.sin(phi) ** 2 + 1) * np.sin(theta)
            ),
            0,
            np.pi / 2,
            0,
            np.pi / 2,
        )
        assert np.sqrt((nx + 2) * (ny + 2)) / (2 * np.pi) * 4 * total == pytest.approx(1, rel=1e-6)
        d = ltmd.AshikhminShirley(nx, ny)
        for theta in (0, 1e-3, 0.3, 1.4):
            for phi in (0, 0.5, np.pi / 2, 4):
                exponent = nx * np.cos(phi) ** 2 + ny * np.sin(phi) ** 2
                peak = np.sqrt((nx + 2) * (ny + 2)) / (2 * np.pi)
                expected = peak * np.cos(theta) ** exponent
                m = direction(theta, phi)
                assert d.D(m) == pytest.approx(expected, rel=1e-12)
                slope = -m[:2] / m[2]
                assert d.P22(slope) == pytest.approx(expected * m[2] ** 4, rel=1e-12)


@pytest.mark.parametrize(("name", "value"), CASES)
def test_d_is_the_unit_form_at_another_scale(name, value):
    d = make(name, value)
    theta = np.append(scale_of(name, value) * np.linspace(0, 3, 100), [0.7, 1.2, 1.5])
    theta = theta[theta < 1.57]
    m = np.stack([direction(t) for t in theta])
    unit = ltmd.unit_mdf(name, value, theta)
    # Schlick's ends within one cosine's rounding; a tail times an error of eps in the angle.
    np.testing.assert_allclose(d.D(m) / d.D(direction(0)), unit, rtol=1e-9, atol=1e-9)
    slopes = np.stack([np.tan(theta), 0 * theta], axis=-1)
    p22 = d.P22(slopes) / d.P22(np.zeros(2))
    np.testing.assert_allclose(p22, unit * np.cos(theta) ** 4, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("name", "value"), CASES)
def test_d_cos_integrates_to_one(name, value):
    d, scale = make(name, value), scale_of(name, value)
    edges = np.unique([0, *(np.pi / 2 * np.minimum(1, scale * 2.0 ** np.arange(-2, 40)))])
    if name == "schlick_m":
        edges = np.unique([*edges, np.arccos(1 - value)])
    assert integral(lambda t: d.D(direction(t)), edges) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize(("name", "value"), CASES)
def test_masking_is_the_smith_integral(name, value):
    """Against the table of Tabulated(P22), itself tested, and against quadrature of D."""
    d, scale = make(name, value), scale_of(name, value)
    for theta in (0.3, 1.0, 1.4, np.pi / 2 - scale / 2):
        v = direction(theta)

        def ring(t, theta=theta):
            a, b = np.cos(theta) * np.cos(t), np.sin(theta) * np.sin(t)
            phi = np.arccos(-np.clip(a / b, -1, 1)) if b > 0 else np.pi
            return d.D(direction(t)) * np.sin(t) * 2 * (a * phi + b * np.sin(phi))

        edges = np.unique(
            [0, *(np.pi / 2 * np.minimum(1, scale * 2.0 ** np.arange(-2, 30))), np.pi / 2 - theta]
        )
        if name == "schlick_m":
            edges = np.unique([*edges, np.arccos(1 - value)])
        expected = sum(
            scipy.integrate.quad(ring, a, b, epsabs=1e-12, epsrel=1e-9, limit=200)[0]
            for a, b in zip(edges, edges[1:], strict=False)
        )
        assert d.projected_area(v) == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize(("name", "value"), CASES)
def test_samples_follow_the_radial_distribution(name, value, rng):
    d, scale = make(name, value), scale_of(name, value)
    m = d.sample(rng.random((20_000, 2)))
    theta = np.arctan2(np.hypot(m[:, 0], m[:, 1]), m[:, 2])
    edges = scale * np.array([0.2, 0.4, 0.6, 0.8, 1.0, 1.3])
    edges = edges[edges < np.pi / 2]
    inside = [integral(lambda t: d.D(direction(t)), (0, e / 2, e)) for e in edges]
    expected = np.diff([0, *inside, 1]) * len(theta)
    observed = np.histogram(theta, [0, *edges, 2])[0]
    keep = expected > 5
    statistic = np.sum((observed - expected)[keep] ** 2 / expected[keep])
    assert scipy.stats.chi2.sf(statistic, keep.sum() - 1) > 0.01 / len(CASES)


@pytest.mark.parametrize(
    "d",
    [make(*case.values) for case in CASES]
    + [ltmd.AshikhminShirley(0.01, 1000), ltmd.AshikhminShirley(1e13, 0.01)],
    ids=repr,
)
def test_float32_is_float64_rounded(d, rng):
    theta = np.append(np.pi / 2 * rng.random(500), [0, 1e-6, np.pi / 2 - 1e-7])
    v = np.stack([direction(t) for t in theta]).astype(np.float32)
    u = rng.random((len(v), 2), dtype=np.float32)
    u[:4] = [[0, 0], [1, 1], [0, 1], [1, 0]]
    full = v.astype(np.float64)
    samples = d.sample(u.astype(float)).astype(np.float32)
    for m in (v, samples):
        single, exact = d.D(m), d.D(m.astype(float))
        assert np.all(np.isfinite(single))
        assert np.all(single >= 0)
        # Relative where D is not far below its peak: an exponent of 20 loses a factor of 20.
        np.testing.assert_allclose(
            single, exact, rtol=1e-5, atol=1e-6 * d.D(np.array([0.0, 0, 1])) + 1e-37
        )
    np.testing.assert_allclose(d.G1(v), d.G1(full), rtol=2e-6, atol=1e-30)
    for m in (d.sample(u), d.sample_visible(v, u)):
        assert np.all(np.isfinite(m))
        assert np.all(m[:, 2] >= 0)
        np.testing.assert_allclose(np.linalg.norm(m, axis=1), 1, atol=1e-6)


REFUSED = [
    *(("Gauss", (m,), r"m is .*\[1e-06, 2\]") for m in (0, -1, 2.1, np.nan, np.inf)),
    *(("SchlickMDF", (m,), r"m is .*\[1e-06, 1\]") for m in (0, -1, 1.1, np.nan, np.inf)),
    *(("SawickiDS", (N,), r"N is .*\[0.01, 1e\+13\]") for N in (0, -1, 1e14, np.nan, np.inf)),
    *(
        ("AshikhminShirley", (N, 1), r"nx is .*\[0.01, 1e\+13\]")
        for N in (0, -1, 1e14, np.nan, np.inf)
    ),
    ("AshikhminShirley", (1, 0), r"ny is 0; .*\[0.01, 1e\+13\]"),
]


@pytest.mark.parametrize(("name", "arguments", "match"), REFUSED)
def test_refusals_name_the_range(name, arguments, match):
    with pytest.raises(ValueError, match=match):
        getattr(ltmd, name)(*arguments)


@pytest.mark.parametrize(("nx", "ny"), [(10, 10), (1, 100), (0.01, 1000), (1e5, 20)])
def test_ashikhmin_shirley_masking_and_samples(nx, ny, rng):
    """After the map that makes it nearly isotropic, which judges can resolve."""
    d = ltmd.AshikhminShirley(nx, ny).transformed(np.sqrt(np.diag([2 / (nx + 2), 2 / (ny + 2)])))
    for degrees in (0, 30, 60, 80, 89, 89.9):
        v = direction(np.radians(degrees))
        assert facing_area(d, v, 1) == pytest.approx(d.projected_area(v), rel=1e-5)
        m = d.sample_visible(v, rng.random((100_000, 2)))
        assert np.all(m @ v > -1e-15)
        assert chi_squared(m, lambda n, v=v: d.pdf_visible(v, n), 1) > smallest_p(4 * 7)
    m = d.sample(rng.random((100_000, 2)))
    assert chi_squared(m, d.pdf, 1) > smallest_p(4 * 7)
