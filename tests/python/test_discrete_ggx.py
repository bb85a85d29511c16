# SPDX-License-Identifier: Apache-2.0
"""Discrete GGX against sums over its facets, each cap integrated by quadrature."""

import ltmd
import numpy as np
import pytest
import scipy.stats
from microfacet import direction, panels, smallest_p

ANGLES = np.radians([0, 20, 60, 80, 89, 89.9])


def density_in_cap(d):
    """What each facet adds to D inside its cap: 1 / facets of the projected area."""
    return 1 / (d.facets * np.pi * np.sin(d.cone) ** 2 * d.normals[:, 2])


def rings(a, b):
    """The integral over phi of max(0, a + b cos(phi)), b >= 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        phi = np.where(b > 0, np.arccos(-np.clip(a / b, -1, 1)), np.where(a > 0, np.pi, 0))
    return 2 * (a * phi + b * np.sin(phi))


def projected_area(d, v):
    total = 0
    for normal, weight in zip(d.normals, density_in_cap(d), strict=True):
        cosine = np.clip(normal @ v, -1, 1)
        sine = np.sqrt(1 - cosine**2)
        # From this angle to the axis on, a part of the ring faces away.
        turned = np.arcsin(abs(cosine))
        edges = [0, d.cone]
        if turned < d.cone:
            near = (d.cone - turned) * 0.3 ** np.arange(12)
            edges = np.unique([0, *(turned + near), turned, d.cone])
        psi, weights = panels(edges, 16)
        total += weight * np.sum(
            weights * np.sin(psi) * rings(cosine * np.cos(psi), sine * np.sin(psi))
        )
    return total


@pytest.mark.parametrize(
    "d",
    [
        ltmd.DiscreteGGX(0.5, 5, 0.3, 0),
        ltmd.DiscreteGGX(0.2, 300, 0.02, 1),
        ltmd.DiscreteGGX(0.3, 60, 1e-3, 2),
        ltmd.DiscreteGGX(3.0, 40, 1.0, 3),
        ltmd.DiscreteGGX(100.0, 40, 0.1, 4),
    ],
    ids=repr,
)
def test_d_and_masking_are_sums_over_the_facets(d, rng):
    m = d.sample(rng.random((2000, 2)))
    inside = m @ d.normals.T - np.cos(d.cone)
    clear = np.all(np.abs(inside) > 1e-12, axis=1)
    expected = (inside > 0) @ density_in_cap(d)
    np.testing.assert_allclose(d.D(m)[clear], expected[clear], rtol=1e-12)
    assert np.all(d.D(m) > 0)
    assert np.all(d.normals[:, 2] >= np.sin(d.cone) - 1e-12)
    assert projected_area(d, np.array([0.0, 0, 1])) == pytest.approx(1, abs=1e-9)
    for theta in ANGLES:
        v = direction(theta, 2.0)
        # Quadrature of a root at the ring that turns away.
        assert d.projected_area(v) == pytest.approx(projected_area(d, v), rel=1e-7)
        assert d.projected_area(3 * v) == pytest.approx(3 * d.projected_area(v), rel=1e-12)


@pytest.mark.parametrize("matrix", [np.diag([2.0, 0.5]), np.array([[1.0, 0], [2, 1]])])
def test_the_weak_furnace_under_a_map(matrix):
    """The integral of D_M(m) max(0, v.m), over the base's caps: there D_M is smooth."""
    d = ltmd.DiscreteGGX(0.5, 3, 0.2, 0)
    d_m = d.transformed(matrix)
    psi, psi_weights = panels(np.linspace(0, d.cone, 5), 12)
    phi = 2 * np.pi * (np.arange(512) + 0.5) / 512
    for theta in (0, 1.0, 1.5):
        v = direction(theta)
        total = 0
        for n, weight in zip(d.normals, density_in_cap(d), strict=True):
            a = np.cross(n, [0.6, 0.8, 0])
            a /= np.linalg.norm(a)
            b = np.cross(n, a)
            ring = np.cos(phi)[:, None] * a + np.sin(phi)[:, None] * b
            u = np.cos(psi)[:, None, None] * n + np.sin(psi)[:, None, None] * ring
            m = np.concatenate([u[..., :2] @ np.linalg.inv(matrix), u[..., 2:]], axis=-1)
            m /= np.linalg.norm(m, axis=-1, keepdims=True)
            # dm = |M^T m|^3 / |det M| du; to d_m.D(m) other caps may add, so one cap's share of it.
            stretched = np.concatenate([m[..., :2] @ matrix, m[..., 2:]], axis=-1)
            size = np.linalg.norm(stretched, axis=-1)
            share = abs(np.linalg.det(matrix)) / size**4 * weight
            values = share * size**3 / abs(np.linalg.det(matrix)) * np.maximum(0, m @ v)
            total += (psi_weights * np.sin(psi)) @ values.sum(axis=1) * 2 * np.pi / 512
            whole = (u @ d.normals.T > np.cos(d.cone) + 1e-12) @ density_in_cap(d)
            np.testing.assert_allclose(
                d_m.D(m), whole * abs(np.linalg.det(matrix)) / size**4, rtol=1e-9
            )
        assert d_m.G1(v) * total / v[2] == pytest.approx(1, abs=1e-4)


def angles_around(axis, m):
    """The angle of m to the axis, and its angle about the axis."""
    a = np.cross(axis, [0.6, 0.8, 0.0])
    a /= np.linalg.norm(a)
    b = np.cross(axis, a)
    return np.arccos(np.clip(m @ axis, -1, 1)), np.arctan2(m @ b, m @ a) % (2 * np.pi)


SEEDS = range(4)
VIEWS = [0.0, 1.0, 1.4, 1.55]


@pytest.mark.parametrize("cone", [0.02, 0.3, 1.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_samples_of_a_cap_follow_their_density(seed, cone, rng):
    d = ltmd.DiscreteGGX(2.0, 1, cone, seed)
    axis = d.normals[0]
    edges = cone * np.sqrt(np.linspace(0, 1, 7)), np.linspace(0, 2 * np.pi, 13)
    fine = 48
    psi = np.concatenate(
        [panels(np.linspace(*e, fine + 1), 1) for e in zip(edges[0], edges[0][1:], strict=False)],
        axis=1,
    )
    phi, phi_weights = panels(np.linspace(0, 2 * np.pi, 12 * fine + 1), 1)
    a = np.cross(axis, [0.6, 0.8, 0.0])
    a /= np.linalg.norm(a)
    b = np.cross(axis, a)
    ring = np.cos(phi)[:, None] * a + np.sin(phi)[:, None] * b
    m = np.cos(psi[0])[:, None, None] * axis + np.sin(psi[0])[:, None, None] * ring
    area = (np.sin(psi[0]) * psi[1])[:, None] * phi_weights
    count = 100_000
    for theta in VIEWS:
        # A view that the cap half turns away from, where there is one.
        v = direction(theta, np.arctan2(-axis[1], -axis[0]))
        cells = (area * np.maximum(0, m @ v)).reshape(6, fine, 12, fine).sum(axis=(1, 3))
        if cells.sum() < 1e-9:
            assert d.projected_area(v) < 1e-6
            continue
        expected = count * cells / cells.sum()
        samples = d.sample_visible(v, rng.random((count, 2)))
        assert np.all(samples @ v >= -1e-12)
        observed, _, _ = np.histogram2d(*angles_around(axis, samples), bins=edges)
        many = expected > 20
        f = np.append(expected[many], expected[~many].sum() + 1e-9)
        o = np.append(observed[many], count - observed[many].sum())
        keep = f > 5
        p = scipy.stats.chi2.sf(np.sum((o - f)[keep] ** 2 / f[keep]), max(1, keep.sum() - 1))
        assert p > smallest_p(len(SEEDS) * 3 * len(VIEWS)), theta


@pytest.mark.parametrize("theta", VIEWS)
def test_facets_are_seen_by_their_projected_area(theta, rng):
    # Caps so narrow that few overlap; a sample goes to the nearest.
    d = ltmd.DiscreteGGX(0.7, 40, 1e-3, 5)
    v = direction(theta)
    m = d.sample_visible(v, rng.random((200_000, 2)))
    observed = np.bincount(np.argmax(m @ d.normals.T, axis=1), minlength=40)
    expected = np.maximum(0, d.normals @ v) / d.normals[:, 2] / d.facets
    expected *= len(m) / d.projected_area(v)
    keep = expected > 50
    statistic = np.sum((observed - expected)[keep] ** 2 / expected[keep])
    assert scipy.stats.chi2.sf(statistic, keep.sum() - 1) > smallest_p(len(VIEWS))


def test_a_seed_is_a_surface():
    d = ltmd.DiscreteGGX(0.3, 1000, 0.01, 7)
    np.testing.assert_array_equal(d.normals, ltmd.DiscreteGGX(0.3, 1000, 0.01, 7).normals)
    assert np.all(d.normals != ltmd.DiscreteGGX(0.3, 1000, 0.01, 8).normals)
    r2 = (d.normals[:, 0] ** 2 + d.normals[:, 1] ** 2) / d.normals[:, 2] ** 2
    assert scipy.stats.kstest(r2 / (r2 + 0.3**2), "uniform").pvalue > 0.01


def test_many_facets_are_ggx():
    d, ggx = ltmd.DiscreteGGX(0.3, 1_000_000, 0.05, 0), ltmd.GGX(0.3)
    for theta in (0, 0.3, 0.8, 1.2, 1.5):
        v = direction(theta)
        # A cap holds the share pi cone^2 D cos of the facets, less at the end where GGX is blurred.
        facets = 1e6 * np.pi * 0.05**2 * ggx.D(v) * v[2]
        blur = 0.05**2 / 0.3**2
        assert d.D(v) == pytest.approx(ggx.D(v), rel=blur + 5 / np.sqrt(facets))
        # The normals near the horizon that are left out have 2 % of the mean slope.
        assert d.projected_area(v) == pytest.approx(ggx.projected_area(v), rel=0.02)


def test_float32_has_places_in_every_cap(rng):
    d = ltmd.DiscreteGGX(0.3, 100_000, 0.01, 0)
    u = rng.random((20_000, 2), dtype=np.float32)
    u[:4] = [[0, 0], [1, 1], [0, 1], [1, 0]]
    v = direction(1.0).astype(np.float32)
    for m in (d.sample(u), d.sample_visible(v, u)):
        assert np.all(np.isfinite(m))
        full = m.astype(np.float64)
        full /= np.linalg.norm(full, axis=1, keepdims=True)
        # Rounding to float32 moves few out of their cap.
        assert np.mean(d.D(full) > 0) > 0.999
    views = np.stack([direction(t, 1.0) for t in np.pi / 2 * rng.random(200)])
    single = d.G1(views.astype(np.float32))
    np.testing.assert_allclose(single, d.G1(views), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ((0, 10, 0.1), r"alpha is 0; it must be in \[1e-06, 1e\+06\]"),
        ((np.nan, 10, 0.1), "alpha is nan"),
        ((0.3, 0, 0.1), r"facets is 0; it must be in \[1, 1e\+07\]"),
        ((0.3, 1e8, 0.1), r"facets is 1e\+08"),
        ((0.3, 1.5, 0.1), "facets is 1.5; it must be a whole number"),
        ((0.3, np.nan, 0.1), "facets is nan"),
        ((0.3, 10, 9e-4), r"cone is 0.0009; it must be in \[0.001, 1\]"),
        ((0.3, 10, 1.1), "cone is 1.1"),
        ((0.3, 10, np.nan), "cone is nan"),
    ],
)
def test_refusals_name_the_range(arguments, match):
    with pytest.raises(ValueError, match=match):
        ltmd.DiscreteGGX(*arguments)
