# SPDX-License-Identifier: Apache-2.0
"""Beckmann's distribution, its masking and its visible normals against rays cast on a random
surface, as it is and under M (masking-shadowing, figure 11; microsurface-transformations, eq. 12).

Smith's model takes the facets that hide a point to be independent of the point. Two results do
not depend on that and are met within sampling error: the visible area (eq. 14), and masking as
the visible part of the projected area of what faces v. The others are met within the error of that
assumption, which the tests bound by what was measured on surfaces of this kind.
"""

import ltmd
import numpy as np
import pytest
import scipy.stats
from heightfield import Heightfield, gaussian_heights
from microfacet import direction

pytestmark = pytest.mark.slow

ALPHA = 0.8
SEEDS = 6
POINTS = 20_000
MAPS = {"identity": np.eye(2), "stretch and shear": np.array([[1.6, 0.9], [0.0, 0.7]])}
ANGLES = {"30": np.radians(30), "60": np.radians(60), "75": np.radians(75), "85": np.radians(85)}
each_map = pytest.mark.parametrize("M", MAPS)
each_angle = pytest.mark.parametrize("angle", ANGLES)
# Of the t-tests below; 1 % for all of them.
TESTS = 3 * len(MAPS) * len(ANGLES)


def model(M):
    return ltmd.Beckmann(ALPHA).transformed(MAPS[M])


@pytest.fixture(scope="module")
def surfaces():
    made = [gaussian_heights(np.random.default_rng(s), 512, 16, ALPHA) for s in range(SEEDS)]
    return {name: [Heightfield(h, M) for h in made] for name, M in MAPS.items()}


@pytest.fixture(scope="module")
def measured(surfaces):
    """For each map and angle and seed: the visible area over cos, the area of what faces v, and
    the fraction seen of what faces v, by area and by count."""
    result = {}
    for name, fields in surfaces.items():
        for angle, theta in ANGLES.items():
            v = direction(theta)
            rows = []
            for seed, field in enumerate(fields):
                points, index = field.points(np.random.default_rng(100 + seed), POINTS)
                m = field.normals(index)
                area = np.maximum(0, m @ v) / m[:, 2]
                seen = field.visible(points, index, v)
                rows.append(
                    (
                        np.mean(area * seen) / v[2],
                        np.mean(area),
                        np.sum(area * seen) / np.sum(area),
                        np.sum(seen) / np.sum(area > 0),
                    )
                )
            result[name, angle] = np.array(rows).T
    return result


def p_value(samples, expected):
    return scipy.stats.ttest_1samp(samples, expected).pvalue


@each_map
@each_angle
def test_visible_area_is_the_macrosurfaces(M, angle, measured):
    """eq. 14: a property of every surface, so this judges the rays."""
    assert p_value(measured[M, angle][0], 1) > 0.01 / TESTS


@each_map
@each_angle
def test_facing_area(M, angle, measured):
    expected = model(M).projected_area(direction(ANGLES[angle]))
    assert p_value(measured[M, angle][1], expected) > 0.01 / TESTS


@each_map
@each_angle
def test_masking(M, angle, measured):
    v = direction(ANGLES[angle])
    by_area, by_count = measured[M, angle][2:]
    expected = model(M).G1(v)
    assert p_value(by_area, expected) > 0.01 / TESTS
    # A facet's own neighbours hide it more often than independent ones would, up to 9 % here.
    assert 0.90 * expected < by_count.mean() < 1.005 * expected
    # The distribution without M, or another model, is farther off.
    if angle in ("75", "85"):
        assert p_value(by_area, v[2]) < 1e-4


@each_map
@each_angle
def test_visible_normals(M, angle, surfaces, rng):
    d, v = model(M), direction(ANGLES[angle])
    along = v[:2] / np.hypot(*v[:2])

    def slopes(m):
        return -(m[:, :2] / m[:, 2:]) @ along

    seen = np.concatenate([slopes(f.visible_normals(rng, v, POINTS)) for f in surfaces[M]])
    u = rng.random((500_000, 3))
    distance = scipy.stats.ks_2samp(seen, slopes(d.sample_visible(v, u[:, :2]))).statistic
    # Smith's independence costs up to 4 % of the distribution function here.
    assert distance < 0.05
    if angle in ("75", "85"):
        grooves = slopes(ltmd.v_cavity_sample_visible(d, v, u))
        assert scipy.stats.ks_2samp(seen, grooves).statistic > 3 * distance


def joint(field, rng, wi, wo):
    """The fraction of the points that face both directions which both see."""
    points, index = field.points(rng, POINTS)
    m = field.normals(index)
    seen = [field.visible(points, index, w) for w in (wi, wo)]
    facing = [m @ w * np.sign(w[2]) > 0 for w in (wi, wo)]
    return np.sum(seen[0] & seen[1]) / np.sum(facing[0] & facing[1])


def test_two_directions_in_one_azimuth_share_their_masking(surfaces, rng):
    d = model("identity")
    wi, m = direction(np.radians(80)), np.array([0.0, 0.0, 1.0])
    for turn in (0.0, 0.2, 0.5):
        wo = direction(np.radians(80), 0.6 + turn)
        measured = np.mean([joint(f, rng, wi, wo) for f in surfaces["identity"][:4]])
        g = {name: ltmd.G2(d, wi, wo, m, name) for name in ltmd.MASKING_MODELS[:4]}
        assert g["height_direction_correlated"] == pytest.approx(measured, rel=0.12)
    # In one direction half of what is seen would be lost without the correlation.
    same = joint(surfaces["identity"][0], rng, wi, wi)
    assert ltmd.G2(d, wi, wi, m, "separable") < 0.6 * same


def test_the_two_sides_see_other_heights(surfaces, rng):
    d = model("identity")
    wi, m = direction(np.radians(80)), np.array([0.0, 0.0, 1.0])
    wo = -direction(np.radians(80), 2.0)
    measured = np.mean([joint(f, rng, wi, wo) for f in surfaces["identity"][:4]])
    heights = ltmd.G2(d, wi, wo, m, "height_correlated")
    independent = ltmd.G2(d, wi, wo, m, "separable")
    assert abs(heights - measured) < 0.5 * abs(independent - measured)
