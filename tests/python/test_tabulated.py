# SPDX-License-Identifier: Apache-2.0
"""Distributions given by their P22 alone, and the tables behind distributions without closed forms.

Tolerances are the stated ones: 1e-6 for projected areas, and for P22 where it has its mass.
"""

import ltmd
import numpy as np
import pytest
import scipy.integrate
import scipy.special
import scipy.stats
from microfacet import chi_squared, direction, smallest_p

THETA = np.radians([0, 0.01, 1, 5, 20, 45, 60, 75, 85, 89, 89.9, 89.99])
VIEWS = np.stack([direction(theta) for theta in THETA])


def ggx(alpha):
    return ltmd.Tabulated(lambda r: (1 + (r / alpha) ** 2) ** -2.0)


def beckmann(alpha):
    return ltmd.Tabulated(lambda r: np.exp(-((r / alpha) ** 2)))


def along(r):
    return np.stack([r, np.zeros_like(r)], axis=-1)


@pytest.mark.parametrize("alpha", [1e-5, 0.01, 0.3, 3.0, 1e5])
def test_ggx_from_its_p22_is_ggx(alpha):
    d, exact = ggx(alpha), ltmd.GGX(alpha)
    np.testing.assert_allclose(d.projected_area(VIEWS), exact.projected_area(VIEWS), rtol=1e-6)
    s = along(alpha * np.geomspace(1e-5, 10, 50))
    np.testing.assert_allclose(d.P22(s), exact.P22(s), rtol=5e-5)
    slopes = along(alpha * np.linspace(0, 2, 50))
    np.testing.assert_allclose(d.P22(slopes), exact.P22(slopes), rtol=5e-6)


@pytest.mark.parametrize("alpha", [0.01, 0.3, 3.0])
def test_beckmann_from_its_p22_has_its_masking(alpha):
    a = 1 / (np.tan(THETA[1:]) * alpha)
    exact = (np.exp(-(a**2)) / (a * np.sqrt(np.pi)) - scipy.special.erfc(a)) / 2
    area = beckmann(alpha).projected_area(VIEWS[1:])
    np.testing.assert_allclose(area, VIEWS[1:, 2] * (1 + exact), rtol=1e-6)


def test_a_transformed_table_is_the_anisotropic_classic(rng):
    d = ggx(0.2).transformed(np.diag([0.2 / 0.5, 0.2 / 0.05]))
    exact = ltmd.GGX(0.5, 0.05)
    np.testing.assert_allclose(d.projected_area(VIEWS), exact.projected_area(VIEWS), rtol=1e-6)
    m = exact.sample(rng.random((1000, 2)))
    np.testing.assert_allclose(d.D(m), exact.D(m), rtol=2e-3)
    near = exact.D(m) > 1e-3 * exact.D(direction(0))
    np.testing.assert_allclose(d.D(m)[near], exact.D(m)[near], rtol=1e-5)


def area_by_quadrature(p22, end, theta, points):
    """The projected area of an isotropic p22(r) that is 0 beyond `end`, up to its scale."""
    c, s = np.cos(theta), np.sin(theta)

    def ring(r):
        phi = np.arccos(np.clip(c / max(s * r, 1e-300), -1, 1))
        return p22(r) * r * 2 * (c * (np.pi - phi) + s * r * np.sin(phi))

    edges = np.unique([0, *points, end, min(end, c / max(s, 1e-300))])
    return sum(
        scipy.integrate.quad(ring, a, b, epsabs=0, epsrel=1e-11)[0]
        for a, b in zip(edges, edges[1:], strict=False)
    )


R = np.array([0.1, 0.2, 0.5, 1.0])
P = np.array([0.9, 2.0, 0.5, 0.3])


def test_arrays_are_linear_between_slopes_and_end_at_the_last():
    d = ltmd.Tabulated(R, P)
    scale = area_by_quadrature(lambda r: np.interp(r, R, P), 1, 0, R)
    r = np.array([0, 0.05, 0.1, 0.16, 0.35, 0.77, 1.0, 1.0001, 5, 1e20])
    expected = np.where(r <= 1, np.interp(r, R, P), 0) / scale
    np.testing.assert_allclose(d.P22(along(r)), expected, rtol=1e-13)


@pytest.mark.parametrize(
    ("d", "p22", "end", "points"),
    [
        (ltmd.Tabulated(R, P), lambda r: np.interp(r, R, P), 1.0, R),
        (ltmd.Tabulated(lambda r: 1.0 * (r < 0.3)), lambda r: 1.0, 0.3, []),
        (
            ltmd.Tabulated(lambda r: np.exp(-(((r - 0.5) / 0.05) ** 2))),
            lambda r: np.exp(-(((r - 0.5) / 0.05) ** 2)),
            1.0,
            [0.35, 0.5, 0.65],
        ),
    ],
    ids=["table", "jump", "ring"],
)
def test_projected_area_is_the_integral(d, p22, end, points):
    scale = area_by_quadrature(p22, end, 0, points)
    for theta, v in zip(THETA, VIEWS, strict=True):
        expected = area_by_quadrature(p22, end, theta, points) / scale
        assert d.projected_area(v) == pytest.approx(expected, rel=1e-6)
        assert d.G1(v) == pytest.approx(v[2] / expected, rel=1e-6)


STEEP = {
    "table": (ltmd.Tabulated(R, np.append(P[:-1], 0)), 0.5),
    "sharp ring": (ltmd.Tabulated(lambda r: np.exp(-(((r - 0.5) / 0.02) ** 2))), 0.5),
    "two scales": (
        ltmd.Tabulated(lambda r: np.exp(-((r / 0.003) ** 2)) / 0.003**2 + 1 / (1 + r**2) ** 2),
        0.05,
    ),
}
EXTREMES = [1e-4, 1e-2, 1.0, 1.57, np.pi / 2 - 1e-6]


@pytest.mark.parametrize("name", STEEP)
@pytest.mark.parametrize("theta", EXTREMES)
def test_visible_samples_at_extreme_angles(name, theta, rng):
    d, scale = STEEP[name]
    v = direction(theta)
    m = d.sample_visible(v, rng.random((200_000, 2)))
    assert np.all(m @ v >= -1e-15)
    p = chi_squared(m, lambda n: d.pdf_visible(v, n), scale, order=24)
    assert p > smallest_p(len(STEEP) * len(EXTREMES))


def test_samples_follow_the_radial_distribution(rng):
    d = ltmd.Tabulated(lambda r: 1.0 * (r < 0.3))
    m = d.sample(rng.random((100_000, 2)))
    r2 = (m[:, 0] ** 2 + m[:, 1] ** 2) / m[:, 2] ** 2 / 0.3**2
    assert scipy.stats.kstest(r2, "uniform").pvalue > 0.01


def test_float32_is_float64_rounded(rng):
    for alpha in (1e-5, 0.3, 1e5):
        d = ggx(alpha)
        theta = np.append(np.pi / 2 * rng.random(1000), [0, 1e-20, np.pi / 2 - 1e-7])
        v = np.stack([direction(t) for t in theta]).astype(np.float32)
        u = rng.random((len(v), 2), dtype=np.float32)
        u[:4] = [[0, 0], [1, 1], [0, 1], [1, 0]]
        for name, arguments in {
            "D": (v,), "G1": (v,), "projected_area": (v,), "sample": (u,), "sample_visible": (v, u),
        }.items():  # fmt: skip
            single = getattr(d, name)(*arguments)
            full = getattr(d, name)(*(a.astype(np.float64) for a in arguments))
            assert single.dtype == np.float32
            assert np.all(np.isfinite(single))
            np.testing.assert_allclose(single, full, rtol=4e-7, atol=1e-37)
            if name.startswith("sample"):
                assert np.all(single[:, 2] >= 0)
            else:
                assert np.all(single >= 0)


def test_the_horizon_and_the_normal_have_values():
    d = ggx(0.3)
    assert d.D(np.array([1.0, 0, 0])) == 0
    assert d.D(np.array([1.0, 0, 1e-90])) == 0
    assert d.D(np.array([1.0, 0, 1e-30], dtype=np.float32)) == 0
    assert d.Lambda(np.array([0.0, 0, 1])) == 0
    assert d.G1(np.array([1.0, 0, 0])) == 0
    assert d.projected_area(np.array([0.0, 0, -1])) == 0
    m = d.sample_visible(np.array([0.0, 0, 1]), np.array([0.3, 0.6]))
    assert np.all(np.isfinite(m))


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (([0, 1], [1, -1]), r"P22 is -1 at the slope 1"),
        (([0, 1], [1, np.nan]), "nan at the slope 1"),
        (([0, 1], [0, 0]), "0 at all slopes"),
        (([0, 1, 1], [1, 1, 1]), r"slope 2 is 1; slopes must increase within \[0, 1e12\]"),
        (([0, 1], [1, 1, 1]), "2 slopes and 3 densities"),
        (([0], [1]), "2 or more"),
        (([-1, 1], [1, 1]), "slope 0 is -1"),
        (([0, 1e13], [1, 1]), "slope 1 is 1e\\+13"),
        (([0, np.inf], [1, 1]), "slope 1 is inf"),
        (([[0, 1]], [1, 1]), "shape"),
        ((lambda r: -r,), "P22 is -"),
        ((lambda r: np.full_like(r, np.inf),), "inf at the slope 0"),
        ((lambda r: 0 * r,), "0 at all slopes"),
        ((lambda r: r[1:],), "densities for"),
        ((lambda r: 1 / (1 + r**2),), "mean slope must be finite"),
        ((lambda r: 1 / (1 + r**3),), "mean slope must be finite"),
    ],
)
def test_refusals_name_what_was_given(arguments, match):
    with pytest.raises(ValueError, match=match):
        ltmd.Tabulated(*arguments)


def test_what_is_no_function_or_raises_is_passed_on():
    with pytest.raises(TypeError, match="function"):
        ltmd.Tabulated(3.0)
    with pytest.raises(TypeError, match="numbers"):
        ltmd.Tabulated(lambda r: "none")
    with pytest.raises(ZeroDivisionError):
        ltmd.Tabulated(lambda r: 1 / 0)


def test_noise_is_taken_with_an_end_to_its_nodes():
    noise = np.random.default_rng(0)
    d = ltmd.Tabulated(lambda r: (1 + noise.random(r.shape)) * np.exp(-(r**2)))
    assert d.projected_area(np.array([0.0, 0, 1])) == 1
