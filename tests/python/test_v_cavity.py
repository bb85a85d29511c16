# SPDX-License-Identifier: Apache-2.0
"""Visible normals of V-cavities, for any symmetric distribution."""

import ltmd
import numpy as np
import pytest
from distributions import DISTRIBUTIONS
from microfacet import ANGLES, MATRICES, chi_squared, direction, smallest_p

SAMPLES = 1_000_000
CASES = [
    (name, matrix)
    for name in ("GGX(0.3)", "GGX(0.5, 0.1)")
    for matrix in ("identity", "stretch", "condition 100")
]


@pytest.mark.parametrize("name, matrix", CASES)
@pytest.mark.parametrize("angle", ["0", "60", "85"])
def test_samples_follow_their_density(name, matrix, angle, rng):
    base, scale = DISTRIBUTIONS[name]
    d, v = base.transformed(MATRICES[matrix]), direction(ANGLES[angle])
    m = ltmd.v_cavity_sample_visible(d, v, rng.random((SAMPLES, 3)))
    # The density has kinks, so cells are finer.
    p = chi_squared(
        m, lambda n: ltmd.v_cavity_pdf_visible(d, v, n), scale, MATRICES[matrix], order=24
    )
    assert p > smallest_p(3 * len(CASES))


def test_density_is_the_visible_part_of_the_facets(rng):
    d = ltmd.GGX(0.6, 0.2)
    m = d.sample(rng.random((1000, 2)))
    v = direction(1.3)
    facing = m @ v
    expected = np.where(facing > 0, ltmd.G1(d, v, m, "v_cavity") * facing * d.D(m) / v[2], 0)
    np.testing.assert_allclose(ltmd.v_cavity_pdf_visible(d, v, m), expected, rtol=1e-12)
    assert ltmd.v_cavity_pdf_visible(d, [1.0, 0.0, 0.0], direction(0.1, 0)) == 0


def test_samples_face_the_view(rng):
    d = ltmd.GGX(1.0)
    v = direction(np.radians(89.9)).astype(np.float32)
    m = ltmd.v_cavity_sample_visible(d, v, rng.random((100_000, 3), dtype=np.float32))
    assert m.dtype == np.float32
    assert np.all(m @ v >= 0)
    # At grazing angles the density is that of a normal map: D cos, twice where it faces (eq. 51).
    half = d.sample(rng.random((100_000, 2)))
    half = half[half @ v.astype(np.float64) > 0]
    error = np.sqrt(np.var(half[:, 2]) * 2 / 50_000)
    assert abs(m[:, 2].mean() - half[:, 2].mean()) < 5 * error
