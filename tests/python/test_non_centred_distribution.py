# SPDX-License-Identifier: Apache-2.0
"""Vertically sheared distributions and correlated slope scales (masking-shadowing, section 5.5)."""

import ltmd
import numpy as np
import pytest
from microfacet import (
    ANGLES,
    MATRICES,
    chi_squared,
    direction,
    facing_area,
    normals,
    panels,
    smallest_p,
)

N = np.array([0.0, 0.0, 1.0])
ALPHA_X, ALPHA_Y, R_XY = 0.4, 0.15, 0.6
CORRELATED = ltmd.GGX(1.0).transformed(ltmd.correlated_stretch(ALPHA_X, ALPHA_Y, R_XY))
OFFSET = np.array([0.3, -0.2])
# The last has a mesosurface that many views see from behind.
SHEARED = {
    "isotropic": (ltmd.GGX(0.3).sheared(*OFFSET), 0.3, OFFSET),
    "correlated": (CORRELATED.sheared(*OFFSET), 0.2, OFFSET),
    "Beckmann": (ltmd.Beckmann(0.4).sheared(*OFFSET), 0.4, OFFSET),
    "steep": (ltmd.GGX(0.5).sheared(-1.5, 0.5), 0.5, np.array([-1.5, 0.5])),
}
AZIMUTHS = (0.6, 2.2, 3.7, 5.3)
each_sheared = pytest.mark.parametrize("name", SHEARED)


def angles(rng, count):
    """Vectors, theta and phi above the horizon."""
    theta, phi = np.arccos(rng.uniform(0.01, 1, count)), rng.uniform(0, 2 * np.pi, count)
    v = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    return v, theta, phi


def test_correlated_stretch(rng):
    m, theta, phi = angles(rng, 1000)
    c, s, tan = np.cos(phi), np.sin(phi), np.tan(theta)
    squared = ALPHA_X**2 * ALPHA_Y**2
    norm2 = tan**2 * (c**2 * ALPHA_Y**2 + s**2 * ALPHA_X**2 - 2 * c * s * R_XY * ALPHA_X * ALPHA_Y)
    norm2 /= squared - R_XY**2 * squared  # eq. 92
    alpha2 = c**2 * ALPHA_X**2 + s**2 * ALPHA_Y**2 + 2 * c * s * R_XY * ALPHA_X * ALPHA_Y  # eq. 93
    constant = 1 / np.sqrt(squared * (1 - R_XY**2))
    expected = constant / (np.pi * np.cos(theta) ** 4 * (1 + norm2) ** 2)  # eq. 85
    np.testing.assert_allclose(CORRELATED.D(m), expected, rtol=1e-12)
    expected = (np.sqrt(1 + alpha2 * tan**2) - 1) / 2  # eq. 86
    np.testing.assert_allclose(CORRELATED.Lambda(m), expected, rtol=1e-12, atol=1e-14)
    stretch = ltmd.correlated_stretch(ALPHA_X, ALPHA_Y, R_XY)
    np.testing.assert_array_equal(stretch, stretch.T)
    assert np.all(np.linalg.eigvalsh(stretch) > 0)
    plain = ltmd.correlated_stretch(0.2, 0.5, 0)
    np.testing.assert_allclose(plain, np.diag([5, 2]), rtol=1e-15, atol=0)


@pytest.mark.parametrize("r", [-1, 1, np.nan])
def test_correlation_is_refused_with_its_range(r):
    with pytest.raises(ValueError, match=r"r_xy is .*between -1 and 1"):
        ltmd.correlated_stretch(0.1, 0.1, r)
    with pytest.raises(ValueError, match="alpha_y is 0; it must be in"):
        ltmd.correlated_stretch(0.1, 0, 0)


def test_the_papers_formula(rng):
    d = SHEARED["correlated"][0]
    m, theta, phi = angles(rng, 1000)
    x = np.tan(theta) * np.cos(phi) + OFFSET[0]
    y = np.tan(theta) * np.sin(phi) + OFFSET[1]
    squared = ALPHA_X**2 * ALPHA_Y**2 * (1 - R_XY**2)
    norm2 = (x**2 * ALPHA_Y**2 + y**2 * ALPHA_X**2 - 2 * x * y * R_XY * ALPHA_X * ALPHA_Y) / squared
    expected = 1 / (np.pi * np.sqrt(squared) * np.cos(theta) ** 4 * (1 + norm2) ** 2)  # eq. 95
    np.testing.assert_allclose(d.D(m), expected, rtol=1e-12)
    slopes = -m[:, :2] / m[:, 2:]
    np.testing.assert_allclose(d.P22(slopes), expected * m[:, 2] ** 4, rtol=1e-12)
    assert np.all(d.D(m * [1, 1, -1]) == 0)

    c, s = np.cos(phi), np.sin(phi)
    alpha2 = c**2 * ALPHA_X**2 + s**2 * ALPHA_Y**2 + 2 * c * s * R_XY * ALPHA_X * ALPHA_Y  # eq. 97
    a = (1 / np.tan(theta) - (c * OFFSET[0] + s * OFFSET[1])) / np.sqrt(alpha2)  # eq. 96
    g1 = np.where(a > 0, 1 / (1 + (np.sqrt(1 + 1 / a**2) - 1) / 2), 0)  # eq. 86, 43
    assert np.any(a < 0)
    np.testing.assert_allclose(d.mesosurface_G1(m), g1, rtol=1e-9, atol=0)
    meso = normals(OFFSET)
    np.testing.assert_allclose(
        d.mesosurface_area(m), np.maximum(0, m @ meso) / (meso @ N), rtol=1e-12, atol=1e-15
    )


@each_sheared
def test_mean_slope_is_the_offset(name):
    """Eq. 94, over slopes in polar form about a point beside the mean."""
    d, scale, offset = SHEARED[name]
    beside = np.array([0.01, 0.02])
    t, weight = panels(np.log(scale) + np.linspace(-12, 18, 61), 12)
    radius = np.exp(t)[:, None]
    phi = np.arange(192) * 2 * np.pi / 192
    slopes = np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=-1) + offset + beside
    density = d.P22(slopes) * radius**2 * weight[:, None] * 2 * np.pi / 192
    assert np.sum(density) == pytest.approx(1, abs=1e-6)
    mean = np.einsum("ij,ijk->k", density, slopes - offset)
    np.testing.assert_allclose(mean, 0, atol=1e-6)


@each_sheared
@pytest.mark.parametrize("matrix", MATRICES)
def test_furnaces(name, matrix):
    base, scale, offset = SHEARED[name]
    M = MATRICES[matrix]
    d = base.transformed(M)
    assert facing_area(d, N, scale, M, offset) == pytest.approx(1, abs=1e-6)
    below = []
    for angle in ANGLES.values():
        for phi in AZIMUTHS:
            v = direction(angle, phi)
            area = facing_area(d, v, scale, M, offset)
            assert area == pytest.approx(d.projected_area(v), rel=1e-6)
            assert area * d.G1(v) == pytest.approx(min(v[2], area), rel=1e-6)
            if matrix == "identity":
                # What is visible of the mesosurface, as the paper has it.
                visible = area * base.mesosurface_G1(v)
                assert visible == pytest.approx(base.mesosurface_area(v), rel=1e-6)
                below.append(base.mesosurface_area(v) == 0)
    assert matrix != "identity" or any(below)


@each_sheared
@pytest.mark.parametrize("matrix", MATRICES)
def test_samples_follow_their_density(name, matrix, rng):
    base, scale, offset = SHEARED[name]
    M = MATRICES[matrix]
    d = base.transformed(M)
    limit = smallest_p(len(SHEARED) * len(MATRICES) * (1 + len(ANGLES)))
    m = d.sample(rng.random((200_000, 2)))
    assert np.all(m[:, 2] >= 0)
    assert chi_squared(m, d.pdf, scale, M, offset) > limit
    for angle, phi in zip(ANGLES.values(), np.resize(AZIMUTHS, len(ANGLES)), strict=True):
        v = direction(angle, phi)
        m = d.sample_visible(v, rng.random((200_000, 2)))
        assert np.all(m[:, 2] >= 0)
        assert chi_squared(m, lambda n, v=v: d.pdf_visible(v, n), scale, M, offset) > limit


def test_visible_normals_where_the_mesosurface_faces_away(rng):
    d, scale, offset = SHEARED["steep"]
    for angle, phi in ((1.3, np.pi), (1.5, 2.5), (0.9, np.pi)):
        v = direction(angle, phi)
        assert d.mesosurface_area(v) == 0
        m = d.sample_visible(v, rng.random((200_000, 2)))
        assert np.all(m @ v > 0)
        assert chi_squared(m, lambda n, v=v: d.pdf_visible(v, n), scale, None, offset) > 0.01 / 3


def test_shears_and_maps_combine_in_either_order(rng):
    v, u = angles(rng, 1000)[0], rng.random((1000, 2))
    M = MATRICES["shear"]
    base = ltmd.GGX(0.4, 0.2)
    first = base.sheared(*OFFSET).transformed(M)
    then = base.transformed(M).sheared(*np.linalg.solve(M.T, OFFSET))
    ellipsoid = ltmd.EllipsoidNDF.from_angles(0.4, 0.2).sheared(*OFFSET).transformed(M)
    for d in (then, ellipsoid):
        np.testing.assert_allclose(first.D(v), d.D(v), rtol=1e-12)
        np.testing.assert_allclose(first.Lambda(v), d.Lambda(v), rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(first.projected_area(v), d.projected_area(v), rtol=1e-9)
    np.testing.assert_allclose(first.sample(u), then.sample(u), rtol=0, atol=1e-12)
    twice = base.sheared(0.1, 0.2).sheared(0.2, -0.4)
    assert twice.base is base
    np.testing.assert_allclose(twice.offset, OFFSET, rtol=1e-15)
    np.testing.assert_allclose(twice.D(v), base.sheared(*OFFSET).D(v), rtol=1e-12)
    np.testing.assert_allclose(base.sheared(0, 0).Lambda(v), base.Lambda(v), rtol=1e-12)


@each_sheared
def test_single_precision(name, rng):
    d, scale, _ = SHEARED[name]
    v = angles(rng, 1000)[0].astype(np.float32)
    exact = v.astype(float)
    rounding = 100 * np.finfo(np.float32).eps / scale
    np.testing.assert_allclose(d.D(v), d.D(exact), rtol=rounding, atol=1e-30)
    np.testing.assert_allclose(d.projected_area(v), d.projected_area(exact), rtol=rounding)
    np.testing.assert_allclose(1 + d.Lambda(v), 1 + d.Lambda(exact), rtol=rounding)
    m = d.sample_visible(v, rng.random((1000, 2)).astype(np.float32))
    assert m.dtype == np.float32
    assert np.all(np.isfinite(m)) and np.all(m[:, 2] >= 0)


def test_offset_is_refused_with_its_range():
    with pytest.raises(ValueError, match=r"offset_x is 2e\+06; it must be in"):
        ltmd.GGX(0.1).sheared(2e6, 0)
    with pytest.raises(ValueError, match="offset_y is nan; it must be in"):
        ltmd.GGX(0.1).sheared(0, np.nan)
