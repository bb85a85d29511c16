# SPDX-License-Identifier: Apache-2.0
"""GGX and Beckmann against Mitsuba 3's MicrofacetDistribution, in float."""

import ltmd
import numpy as np
import pytest

mitsuba = pytest.importorskip("mitsuba")
mitsuba.set_variant("scalar_rgb")

# Mitsuba computes in float; what it takes from cos loses a few digits more.
RELATIVE = 1e-5
ALPHAS = [(0.05, 0.05), (0.3, 0.3), (0.6, 0.15), (1.0, 1.0)]


def directions(rng, count=300):
    theta = np.arccos(rng.uniform(0.05, 1, count))
    phi = rng.uniform(0, 2 * np.pi, count)
    return np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1
    )


@pytest.mark.parametrize("kind", ["GGX", "Beckmann"])
@pytest.mark.parametrize("alphas", ALPHAS)
def test_d_g1_and_pdfs(kind, alphas, rng):
    ours = getattr(ltmd, kind)(*alphas)
    theirs = [
        mitsuba.MicrofacetDistribution(getattr(mitsuba.MicrofacetType, kind), *alphas, visible)
        for visible in (False, True)
    ]
    v, m = directions(rng), ours.sample(rng.random((300, 2)))
    facing = np.einsum("ij,ij->i", v, m) > 0.01
    v, m = v[facing], m[facing]
    expected = np.array(
        [
            (
                theirs[0].eval(n),
                theirs[0].smith_g1(w, n),
                theirs[0].pdf(w, n),
                theirs[1].pdf(w, n),
            )
            for w, n in zip(v.tolist(), m.tolist(), strict=True)
        ]
    ).T
    masking = ours.G1(v)
    if kind == "Beckmann":
        # Mitsuba masks by the rational fit.
        a = v[:, 2] / np.hypot(alphas[0] * v[:, 0], alphas[1] * v[:, 1])
        masking = 1 / (1 + ltmd.beckmann_lambda_rational(a))
    visible = ours.pdf_visible(v, m) * masking / ours.G1(v)
    given = [ours.D(m), masking, ours.pdf(m), visible]
    for one, other in zip(given, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=RELATIVE)
