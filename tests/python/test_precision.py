# SPDX-License-Identifier: Apache-2.0
"""float32 against float64 over the whole range of parameters and directions."""

import numpy as np
import pytest
from distributions import DISTRIBUTIONS
from microfacet import MATRICES

# Directions from the normal to 1e-4 rad of grazing.
THETA = np.concatenate(
    [[0], np.logspace(-6, -1, 26), np.linspace(0.15, 1.5, 28), np.pi / 2 - np.logspace(-1, -4, 10)]
)
VIEWS = np.stack(
    [np.sin(THETA) * np.cos(0.6), np.sin(THETA) * np.sin(0.6), np.cos(THETA)], axis=1
).astype(np.float32)
RANDOM = np.array(
    [[x, y] for x in (0, 1e-7, 0.01, 0.3, 0.7, 0.99, 1 - 2**-24, 1) for y in (0, 0.2, 0.5, 0.9, 1)],
    dtype=np.float32,
)
each_distribution = pytest.mark.parametrize("name", DISTRIBUTIONS)
each_matrix = pytest.mark.parametrize("matrix", ["identity", "condition 100"])


@each_distribution
@each_matrix
def test_density_and_masking_agree(name, matrix):
    d = DISTRIBUTIONS[name][0].transformed(MATRICES[matrix])
    exact = VIEWS.astype(np.float64)
    for function in ("D", "G1", "projected_area"):
        single = getattr(d, function)(VIEWS)
        full = getattr(d, function)(exact)
        assert single.dtype == np.float32
        assert np.all(single >= 0)
        # Rounding of the direction itself is magnified by M's condition.
        representable = (full > 1e-30) & (full < 1e30)
        np.testing.assert_allclose(
            single[representable], full[representable], rtol=2e-5, err_msg=function
        )


@each_distribution
@each_matrix
def test_samples_are_unit_normals_above_the_surface(name, matrix):
    d = DISTRIBUTIONS[name][0].transformed(MATRICES[matrix])
    views = np.repeat(VIEWS, len(RANDOM), axis=0)
    random = np.tile(RANDOM, (len(VIEWS), 1))
    for m in (d.sample(RANDOM), d.sample_visible(views, random)):
        assert np.all(np.isfinite(m))
        assert np.all(m[:, 2] >= 0)
        np.testing.assert_allclose(np.linalg.norm(m, axis=1), 1, atol=4 * np.finfo(np.float32).eps)
    assert np.all(np.isfinite(d.pdf_visible(views, m)))
    assert np.all(d.pdf_visible(views, m) >= 0)
