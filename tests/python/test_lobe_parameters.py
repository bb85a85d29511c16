# SPDX-License-Identifier: Apache-2.0
"""A lobe under tension against a plain float64 model: matrix inverses, SVD."""

import ltmd
import model
import numpy as np
import pytest
from tolerance import EPS

M0S = {
    "none": np.eye(2),
    "shear": ltmd.material_matrix(0.4, 0.7, 0.5),
    "squeeze": ltmd.material_matrix(-0.5, -1.1, -0.3),
    "mirror": np.array([[1.0, 0.2], [0.1, -0.8]]),
}
STRENGTHS = (0, 0.5, 1, 2)


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def strengthened(t, strength):
    """V^s Rot(s phi) of T = V Rot(phi), by the singular values."""
    out = np.empty((len(t), 2, 2))
    for i, matrix in enumerate(model.matrix(t)):
        u, s, vt = np.linalg.svd(matrix)
        turn = u @ vt
        angle = np.arctan2(turn[1, 0], turn[0, 0])
        out[i] = u @ np.diag(s**strength) @ u.T @ rotation(strength * angle)
    return out


def sigma(t, alpha, m0=((1, 0), (0, 1)), strength=1, height_response=0):
    ts = strengthened(t, strength)
    inverse = np.linalg.inv(ts @ m0)
    base = np.diag(np.broadcast_to(alpha, 2).astype(float) ** 2)
    heights = np.linalg.det(ts) ** (-2 * height_response)
    return heights[:, None, None] * np.swapaxes(inverse, 1, 2) @ base @ inverse


def matrix(values):
    xx, xy, yy = np.moveaxis(np.asarray(values, float), -1, 0)
    return np.stack([xx, xy, xy, yy], axis=-1).reshape(*xx.shape, 2, 2)


def lobe(alpha_x, alpha_y, angle):
    """The matrix that parameters stand for."""
    c, s = np.cos(np.float64(angle)), np.sin(np.float64(angle))
    axis = np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)
    values = np.stack([alpha_x, alpha_y], axis=-1).astype(float) ** 2
    return axis * values[:, None, :] @ np.swapaxes(axis, 1, 2)


def assert_same(actual, expected, factor=8):
    size = np.linalg.norm(expected, axis=(1, 2), ord=2)
    error = np.linalg.norm(actual - expected, axis=(1, 2), ord=2)
    assert (error <= factor * EPS * size).all(), (error / size).max() / EPS


@pytest.fixture
def t(rng):
    values = np.exp(rng.normal(0, 0.6, (500, 3)))
    values[:, 1] = rng.normal(0, 1, 500)
    return values.astype(np.float32)


@pytest.mark.parametrize("strength", STRENGTHS)
@pytest.mark.parametrize("m0", M0S, ids=str)
@pytest.mark.parametrize("alpha", [0.2, (0.05, 0.4)], ids=str)
def test_alpha2_is_the_model(t, alpha, m0, strength):
    for height in (0, 0.5, 1):
        expected = sigma(t, alpha, M0S[m0], strength, height)
        actual = ltmd.alpha2(t, alpha, M0S[m0], strength, height)
        assert actual.dtype == np.float32
        assert_same(matrix(actual), expected)


@pytest.mark.parametrize("strength", STRENGTHS)
@pytest.mark.parametrize("m0", M0S, ids=str)
def test_parameters_are_the_eigensystem(t, m0, strength):
    for alpha in (0.2, (0.05, 0.4)):
        expected = sigma(t, alpha, M0S[m0], strength)
        ax, ay, angle = ltmd.lobe_parameters(t, alpha, M0S[m0], strength)
        assert ax.dtype == ay.dtype == angle.dtype == np.float32
        assert (0 < ax).all() and (ax <= ay).all()
        assert (angle >= 0).all() and (angle < np.pi).all()
        values, vectors = np.linalg.eigh(expected)
        assert np.allclose(np.stack([ax, ay], axis=1), np.sqrt(values), rtol=4 * EPS, atol=0)
        along = np.abs(np.sum(vectors[:, :, 0] * np.stack([np.cos(angle), np.sin(angle)], 1), 1))
        clear = values[:, 1] > 1.01 * values[:, 0]
        assert np.allclose(along[clear], 1, atol=1e-6)
        assert_same(lobe(ax, ay, angle), expected)
        rough = ltmd.roughness(t, alpha, M0S[m0], strength)
        twice = 2 * np.float64(angle)
        expected = np.stack([ax, ay, np.cos(twice), np.sin(twice)], axis=1)
        assert np.allclose(rough, expected, atol=1e-6, rtol=0)


@pytest.mark.parametrize("strength", STRENGTHS)
def test_strength_is_a_power_of_g_whatever_the_uv_direction(t, strength):
    """G_s = G^s: the isotropic lobe has alpha^2 G^s, in frames turned on the surface alike."""
    g = np.linalg.inv(model.matrix(t) @ np.swapaxes(model.matrix(t), 1, 2))
    values, vectors = np.linalg.eigh(g)
    expected = vectors * (values**strength)[:, None, :] @ np.swapaxes(vectors, 1, 2)
    assert_same(matrix(ltmd.alpha2(t, 1.0, strength=strength)), expected)
    for angle in (0.3, 1.9):
        # The same map with u turned at rest: T Rot(angle), brought back to triangular form by the
        # turn of u on the deformed surface.
        turned = model.matrix(t) @ rotation(angle)
        turn = np.arctan2(turned[:, 1, 0], turned[:, 0, 0])
        back = np.stack([rotation(-a) for a in turn])
        upper = back @ turned
        other = np.ascontiguousarray(upper[:, [0, 0, 1], [0, 1, 1]], np.float32)
        actual = matrix(ltmd.alpha2(other, 1.0, strength=strength))
        assert_same(np.swapaxes(back, 1, 2) @ actual @ back, expected, factor=100)


def test_at_rest_the_lobe_is_its_own():
    rest = np.array([1, 0, 1], np.float32)
    for strength in STRENGTHS:
        assert ltmd.alpha2(rest, 0.5, strength=strength) == pytest.approx([0.25, 0, 0.25], abs=1e-9)
        ax, ay, angle = ltmd.lobe_parameters(rest, (0.1, 0.4), strength=strength)
        assert (ax, ay, angle) == pytest.approx((0.1, 0.4, 0))
        ax, ay, angle = ltmd.lobe_parameters(rest, (0.4, 0.1), strength=strength)
        assert (ax, ay, angle) == pytest.approx((0.1, 0.4, np.pi / 2))
    assert ltmd.roughness(rest, 0.3).tolist() == pytest.approx([0.3, 0.3, 1, 0])


def test_material_matrix():
    assert np.allclose(ltmd.stretch_matrix(0.5), np.diag([2, 0.5]), atol=0)
    assert np.allclose(ltmd.stretch_matrix(-0.5), np.diag([0.5, 2]), atol=0)
    assert np.array_equal(ltmd.material_matrix(0, 0, 0), np.eye(2))
    expected = rotation(0.7) @ [[1, 0.5], [0, 1]] @ ltmd.stretch_matrix(0.4)
    assert np.allclose(ltmd.material_matrix(0.4, 0.7, 0.5), expected, rtol=1e-14)
    for s in (-1, 1, 1.5, np.nan):
        with pytest.raises(ValueError, match="between -1 and 1"):
            ltmd.stretch_matrix(s)


def test_wrinkle(t):
    m = model.matrix(t)
    u, v = m[:, :, 0], m[:, :, 1]
    expected = np.stack(
        [
            np.linalg.norm(u, axis=1),
            np.linalg.norm(v, axis=1),
            np.pi / 2 - np.arccos(np.sum(u * v, 1) / np.linalg.norm(u, axis=1)
                                  / np.linalg.norm(v, axis=1)),
        ],
        axis=1,
    )  # fmt: skip
    assert np.allclose(ltmd.wrinkle(t), expected, rtol=1e-6, atol=1e-6)
    assert ltmd.wrinkle(np.array([1, 0, 1], np.float32)).tolist() == [1, 1, 0]


def test_leading_axes_are_kept(t):
    block = t[:24].reshape(2, 3, 4, 3)
    assert ltmd.alpha2(block, 0.2).shape == (2, 3, 4, 3)
    assert ltmd.roughness(block, 0.2).shape == (2, 3, 4, 4)
    assert ltmd.wrinkle(block).shape == (2, 3, 4, 3)
    ax, _, angle = ltmd.lobe_parameters(block, 0.2)
    assert ax.shape == angle.shape == (2, 3, 4)
    assert ltmd.lobe_parameters(block[0, 0, 0], 0.2)[0].shape == ()
    assert ltmd.alpha2(np.empty((0, 3), np.float32), 0.2).shape == (0, 3)


def test_refuses_in_words(t):
    with pytest.raises(ValueError, match="invertible"):
        ltmd.alpha2(t, 0.2, [[1, 2], [2, 4]])
    with pytest.raises(ValueError, match=r"shape \(2, 2\), not \(3, 3\)"):
        ltmd.roughness(t, 0.2, np.eye(3))
    with pytest.raises(TypeError, match="M0"):
        ltmd.roughness(t, 0.2, "identity")
    with pytest.raises(ValueError, match="above 0"):
        ltmd.lobe_parameters(t, (0.2, 0))
    with pytest.raises(ValueError, match=r"shape \(2,\), not \(3,\)"):
        ltmd.alpha2(t, (0.1, 0.2, 0.3))
    with pytest.raises(TypeError, match="alpha"):
        ltmd.alpha2(t, "rough")
    with pytest.raises(ValueError, match="strength"):
        ltmd.alpha2(t, 0.2, strength=-1)
    with pytest.raises(TypeError, match="float32"):
        ltmd.alpha2(t.astype(float), 0.2)
    with pytest.raises(ValueError, match="3"):
        ltmd.alpha2(t[:, :2].copy(), 0.2)
    bad = t.copy()
    bad[7, 1] = np.nan
    with pytest.raises(ValueError, match="tension 7"):
        ltmd.alpha2(bad, 0.2)
