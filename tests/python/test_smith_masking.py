# SPDX-License-Identifier: Apache-2.0
"""Smith's masking by quadrature against the closed forms, stretched and sheared."""

import math

import ltmd
import numpy as np
import pytest
from microfacet import MATRICES

A = np.geomspace(0.01, 4, 12)


def ggx(r):
    return 1 / (math.pi * (1 + r * r) ** 2)


def gaussian(r):
    return math.exp(-min(r * r, 700)) / math.pi


SHAPES = {"GGX": (ggx, ltmd.GGX(1.0)), "Beckmann": (gaussian, ltmd.Beckmann(1.0))}


def views(a, phi=0.0):
    """Directions at which a of a distribution with alpha = 1 is `a`."""
    a = np.asarray(a)
    v = np.stack([np.cos(phi) * np.ones_like(a), np.sin(phi) * np.ones_like(a), a], axis=-1)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


@pytest.mark.parametrize("name", SHAPES)
def test_closed_forms(name):
    shape, d = SHAPES[name]
    assert ltmd.shape_integral(shape) == pytest.approx(1, rel=1e-12)
    np.testing.assert_allclose(ltmd.smith_lambda_of_shape(shape, A), d.Lambda(views(A)), rtol=1e-10)


def test_density_along_the_azimuth():
    """eq. 124, for the sums of GGX and Beckmann slopes across the azimuth, eq. 113."""
    lines = {
        "GGX": lambda x: (1 + x * x) ** -1.5 / 2,
        "Beckmann": lambda x: math.exp(-min(x * x, 700)) / math.sqrt(math.pi),
    }
    for name, line in lines.items():
        expected = SHAPES[name][1].Lambda(views(A))
        np.testing.assert_allclose(ltmd.smith_lambda(line, A), expected, rtol=1e-10)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("matrix", MATRICES)
def test_stretch_invariance(name, matrix, rng):
    """eq. 88-93: under M the shape's Lambda is that of the roughness projected onto the azimuth,
    with the quadric Q^-1 = M^-T M^-1."""
    shape, d = SHAPES[name]
    M = MATRICES[matrix]
    phi = rng.uniform(0, 2 * np.pi, 20)
    theta = rng.uniform(0.3, 1.5, 20)
    v = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    inverse = np.linalg.inv(M)
    alpha2 = inverse.T @ inverse
    # eq. 93: cos^2 alpha_x^2 + sin^2 alpha_y^2 + 2 cos sin r alpha_x alpha_y.
    alpha_o = np.sqrt(
        np.cos(phi) ** 2 * alpha2[0, 0]
        + np.sin(phi) ** 2 * alpha2[1, 1]
        + 2 * np.cos(phi) * np.sin(phi) * alpha2[0, 1]
    )
    a = 1 / (alpha_o * np.tan(theta))
    # Far from the horizon of a sharp lobe a Gaussian's Lambda vanishes, absolutely too.
    np.testing.assert_allclose(
        d.transformed(M).Lambda(v), ltmd.smith_lambda_of_shape(shape, a), rtol=1e-9, atol=1e-15
    )


def test_a_shape_of_ones_own_conserves_the_visible_area():
    """eq. 87 with f = exp(-r): the weak white furnace over slopes."""
    c = 1 / ltmd.shape_integral(lambda r: math.exp(-r))
    assert c == pytest.approx(1 / (2 * math.pi), rel=1e-12)
    a = 0.7
    masking = 1 / (1 + ltmd.smith_lambda_of_shape(lambda r: c * math.exp(-r), a))
    x, w = np.polynomial.legendre.leggauss(400)
    slope_x, weight_x = (a - 40) / 2 + (a + 40) / 2 * x, (a + 40) / 2 * w
    slope_y, weight_y = 40 * x, 40 * w
    density = c * np.exp(-np.hypot(slope_x[:, None], slope_y))
    area = weight_x @ ((a - slope_x)[:, None] * density) @ weight_y
    # The quadrature's own error, at the cusp of f.
    assert masking * area / a == pytest.approx(1, abs=5e-4)


def test_refusals():
    with pytest.raises(ValueError, match="converge"):
        ltmd.smith_lambda_of_shape(lambda r: 1 / (1 + r * r), 1)
    with pytest.raises(ValueError, match="a .*0"):
        ltmd.smith_lambda_of_shape(ggx, 0)
    with pytest.raises(ValueError, match="cotangent"):
        ltmd.smith_lambda(ggx, -1)
    with pytest.raises(ZeroDivisionError):
        ltmd.smith_lambda(lambda x: 1 / 0, 1)
