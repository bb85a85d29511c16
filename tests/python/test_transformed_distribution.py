# SPDX-License-Identifier: Apache-2.0
"""The transformation itself, equation by equation (microsurface-transformations, section 4)."""

import ltmd
import numpy as np
import pytest
from microfacet import MATRICES, direction

EPS = np.finfo(float).eps
each_matrix = pytest.mark.parametrize("matrix", MATRICES)


def hemisphere(rng, count=200):
    m = rng.normal(size=(count, 3))
    m[:, 2] = np.abs(m[:, 2]) + 0.05
    return m / np.linalg.norm(m, axis=1, keepdims=True)


def warp(m, M):
    """N(m) of eq. 13."""
    u = np.concatenate([m[..., :2] @ M, m[..., 2:]], axis=-1)
    return u / np.linalg.norm(u, axis=-1, keepdims=True)


def partial_derivatives(m, M):
    """Eq. 17-20 with (a, b, c, d) of eq. 9."""
    (a, c), (b, d) = M
    x, y = m[:, 0], m[:, 1]
    length3 = np.linalg.norm(np.stack([a * x + b * y, c * x + d * y, m[:, 2]]), axis=0) ** 3
    xx = y * y * (a * d * d - b * c * d - a) + x * y * (a * c * d + b - b * c * c) + a
    xy = x * x * (b * c * c - a * c * d - b) + x * y * (b * c * d + a - a * d * d) + b
    yx = y * y * (c * b * b - a * b * d - c) + x * y * (a * b * c + d - d * a * a) + c
    yy = x * x * (d * a * a - a * b * c - d) + x * y * (a * b * d + c - c * b * b) + d
    return np.stack([np.stack([xx, xy], -1), np.stack([yx, yy], -1)], -2) / length3[:, None, None]


@each_matrix
def test_the_partial_derivatives_are_those_of_the_warp(matrix, rng):
    M, m = MATRICES[matrix], hemisphere(rng)
    step = np.cbrt(EPS)
    for axis in range(2):
        moved = []
        for sign in (1, -1):
            n = m.copy()
            n[:, axis] += sign * step
            n[:, 2] = np.sqrt(1 - n[:, 0] ** 2 - n[:, 1] ** 2)
            moved.append(warp(n, M))
        difference = (moved[0] - moved[1])[:, :2] / (2 * step)
        expected = partial_derivatives(m, M)[:, :, axis]
        # The third derivatives grow like the condition over m_z.
        scale = np.linalg.cond(M) ** 3 / m[:, 2:].min() ** 5
        np.testing.assert_allclose(difference, expected, atol=step**2 * scale)


@each_matrix
def test_d_is_the_bases_times_the_warps_jacobian(matrix, rng):
    """Eq. 15, 16, 21, 22."""
    M, m = MATRICES[matrix], hemisphere(rng)
    base = ltmd.GGX(0.3)
    jacobian = np.linalg.det(partial_derivatives(m, M))
    length = np.linalg.norm(np.concatenate([m[:, :2] @ M, m[:, 2:]], axis=1), axis=1)
    tolerance = 100 * EPS * np.linalg.cond(M) ** 2
    np.testing.assert_allclose(jacobian, np.linalg.det(M) / length**4, rtol=tolerance)
    np.testing.assert_allclose(
        base.transformed(M).D(m), np.abs(jacobian) * base.D(warp(m, M)), rtol=tolerance
    )


@each_matrix
def test_masking_goes_with_the_surface(matrix, rng):
    """Eq. 11: G1_M(M v) = G1(v)."""
    M, v = MATRICES[matrix], hemisphere(rng)
    base = ltmd.GGX(0.3)
    moved = np.concatenate([v[:, :2] @ M.T, v[:, 2:]], axis=1)
    moved /= np.linalg.norm(moved, axis=1, keepdims=True)
    np.testing.assert_allclose(
        base.transformed(M).G1(moved), base.G1(v), rtol=100 * EPS * np.linalg.cond(M)
    )


@each_matrix
def test_samples_go_with_the_surface(matrix, rng):
    """Eq. 26, 28: the same random numbers give the base's normals, turned by M^-T."""
    M, u, v = MATRICES[matrix], rng.random((200, 2)), hemisphere(rng)
    base = ltmd.GGX(0.3)
    d = base.transformed(M)
    w = np.concatenate([v[:, :2] @ np.linalg.inv(M).T, v[:, 2:]], axis=1)
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    tolerance = 100 * EPS * np.linalg.cond(M) ** 2
    np.testing.assert_allclose(warp(d.sample(u), M), base.sample(u), atol=tolerance)
    np.testing.assert_allclose(
        warp(d.sample_visible(v, u), M), base.sample_visible(w, u), atol=tolerance
    )


def test_maps_in_a_row_are_the_product(rng):
    m, base = hemisphere(rng), ltmd.GGX(0.2)
    first, second = MATRICES["shear"], MATRICES["stretch"]
    once = base.transformed(second @ first)
    twice = base.transformed(first).transformed(second)
    np.testing.assert_allclose(twice.D(m), once.D(m), rtol=100 * EPS)
    np.testing.assert_allclose(twice.Lambda(m), once.Lambda(m), rtol=100 * EPS)


def test_scaling_heights_is_shrinking_the_plane(rng):
    """Section 4.1: heights times h are the plane's map over h: slopes times h."""
    slopes, base = rng.normal(size=(100, 2)), ltmd.GGX(0.2)
    scaled = base.transformed(np.eye(2) / 3)
    np.testing.assert_allclose(scaled.P22(3 * slopes), base.P22(slopes) / 9, rtol=100 * EPS)


def test_a_warp_acts_through_its_jacobian():
    """Fig. 1: T(u, v) = (u, v + 2 u^5)."""

    def warp_of_figure_1(u, v):
        return u, v + 2 * u**5

    u, v = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 3))
    M = ltmd.jacobian(warp_of_figure_1, u, v)
    assert M.shape == (3, 5, 2, 2)
    np.testing.assert_allclose(M[..., 1, 0], 10 * u**4, atol=1e-9)
    np.testing.assert_allclose(M[..., 0, :], np.broadcast_to([1, 0], M.shape[:-1]), atol=1e-9)
    np.testing.assert_allclose(M[..., 1, 1], 1, atol=1e-9)


def test_a_warp_must_give_two_arrays():
    with pytest.raises(ValueError, match="two arrays"):
        ltmd.jacobian(lambda u, v: u, np.zeros(3), np.zeros(3))
    with pytest.raises(ValueError, match="finite"):
        ltmd.jacobian(lambda u, v: (u + np.inf, v), np.zeros(3), np.zeros(3))


def test_a_view_from_below_sees_nothing():
    d = ltmd.GGX(0.3).transformed(MATRICES["shear"])
    below = -direction(0.5)
    assert d.G1(below) == 0
    assert d.D(below) == 0
    assert d.pdf(below) == 0
    assert d.pdf_visible(below, direction(0.1)) == 0
