# SPDX-License-Identifier: Apache-2.0
"""What must hold for every distribution under every M."""

import ltmd
import numpy as np
import pytest
from distributions import DISTRIBUTIONS
from microfacet import ANGLES, MATRICES, chi_squared, direction, facing_area, furnace, smallest_p

SAMPLES = 1_000_000
each_distribution = pytest.mark.parametrize("name", DISTRIBUTIONS)
each_matrix = pytest.mark.parametrize("matrix", MATRICES)


def transformed(name, matrix):
    base, scale = DISTRIBUTIONS[name]
    return base.transformed(MATRICES[matrix]), scale, MATRICES[matrix]


@each_distribution
@each_matrix
def test_d_cos_integrates_to_one(name, matrix):
    d, scale, M = transformed(name, matrix)
    assert facing_area(d, np.array([0.0, 0.0, 1.0]), scale, M) == pytest.approx(1, abs=1e-4)


@each_distribution
@each_matrix
@pytest.mark.parametrize("angle", ANGLES)
def test_weak_white_furnace(name, matrix, angle):
    d, scale, M = transformed(name, matrix)
    v = direction(ANGLES[angle])
    assert furnace(d, v, scale, M) == pytest.approx(1, abs=1e-4)
    assert facing_area(d, v, scale, M) == pytest.approx(d.projected_area(v), abs=1e-4)


@each_distribution
@each_matrix
def test_samples_follow_their_density(name, matrix, rng):
    d, scale, M = transformed(name, matrix)
    m = d.sample(rng.random((SAMPLES, 2)))
    limit = smallest_p(len(DISTRIBUTIONS) * len(MATRICES))
    assert chi_squared(m, d.pdf, scale, M) > limit


def matrices_and_angles():
    """Every matrix at one angle and every angle under two matrices; the rest takes minutes."""
    for matrix in MATRICES:
        for angle in ANGLES:
            short = matrix in ("identity", "condition 100") or angle == "60"
            yield pytest.param(matrix, angle, marks=() if short else pytest.mark.long)


@each_distribution
@pytest.mark.parametrize(("matrix", "angle"), matrices_and_angles())
def test_visible_samples_follow_their_density(name, matrix, angle, rng):
    d, scale, M = transformed(name, matrix)
    v = direction(ANGLES[angle])
    m = d.sample_visible(v, rng.random((SAMPLES, 2)))
    limit = smallest_p(len(DISTRIBUTIONS) * len(MATRICES) * len(ANGLES))
    assert chi_squared(m, lambda n: d.pdf_visible(v, n), scale, M) > limit


@each_distribution
def test_d_is_p22_over_cos4(name, rng):
    d = DISTRIBUTIONS[name][0].transformed(MATRICES["shear"])
    slopes = rng.normal(size=(1000, 2))
    m = np.append(-slopes, np.ones((1000, 1)), axis=1)
    m /= np.linalg.norm(m, axis=1, keepdims=True)
    expected = d.P22(slopes) / m[:, 2] ** 4
    # Numbers below `tiny` have fewer digits.
    np.testing.assert_allclose(d.D(m), expected, rtol=1e-12, atol=np.finfo(float).tiny)


def test_arrays_keep_their_type_and_leading_axes(rng):
    d = ltmd.GGX(0.3, 0.1)
    v = direction(0.5)
    assert d.sample(rng.random((4, 5, 2), dtype=np.float32)).dtype == np.float32
    m = d.sample(rng.random((4, 5, 2)))
    assert m.shape == (4, 5, 3)
    assert m.dtype == np.float64
    assert d.pdf_visible(v, m).shape == (4, 5)
    np.testing.assert_array_equal(
        d.pdf_visible(v, m), d.pdf_visible(np.broadcast_to(v, m.shape).copy(), m)
    )
    assert d.D(v).shape == ()
    assert d.D(list(v)) == d.D(v)


def test_refusals_name_what_was_given():
    d = ltmd.GGX(0.3)
    with pytest.raises(TypeError, match="int64"):
        d.D(np.zeros((2, 3), dtype=np.int64))
    with pytest.raises(ValueError, match=r"\(\.\.\., 3\), not \(4, 2\)"):
        d.D(np.zeros((4, 2)))
    with pytest.raises(TypeError, match="float32 and u of float64"):
        d.sample_visible(np.zeros((4, 3), dtype=np.float32), np.zeros((4, 2)))
    with pytest.raises(ValueError, match="leading axes"):
        d.pdf_visible(np.zeros((4, 3)), np.zeros((5, 3)))
    with pytest.raises(ValueError, match="invertible"):
        d.transformed([[1, 2], [2, 4]])
    with pytest.raises(ValueError, match="tangent plane"):
        d.transformed([[1, 0, 0], [0, 1, 0.5], [0, 0, 1]])
    with pytest.raises(ValueError, match="shape"):
        d.transformed(np.eye(4))
