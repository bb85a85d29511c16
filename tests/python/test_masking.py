# SPDX-License-Identifier: Apache-2.0
"""Masking models: table 3 of masking-shadowing, and the joint forms against their equations."""

import ltmd
import numpy as np
import pytest
import scipy.special
from microfacet import ANGLES, MATRICES, direction, facing_area

SMITH = ltmd.MASKING_MODELS[:4]
# masking-shadowing, table 3.
CONSERVES_THE_VISIBLE_AREA = {
    **dict.fromkeys(SMITH, True),
    "v_cavity": True,
    "implicit": False,
    "schlick_smith": False,
    "kelemen": False,
}


class Visible:
    """The microfacets that v sees: D(m) G1(v, m)."""

    def __init__(self, d, v, model):
        self.d, self.v, self.model = d, v, model

    def D(self, m):
        return self.d.D(m) * ltmd.G1(self.d, self.v, m, self.model)


def visible_area_over_cosine(d, v, model, scale, M):
    """eq. 14 over its left side; as D(m) dm = D(m_h) dwi / (4 wi.m), also the weak white furnace of
    eq. 36, and the integral of the visible normals, eq. 18."""
    # V-cavities have a kink along two azimuths.
    azimuths = 512 if model == "v_cavity" else 96
    return facing_area(Visible(d, v, model), v, scale, M, azimuths=azimuths) / v[2]


def directions(rng, count, side=1):
    z = rng.random(count) * 0.999 + 0.001
    phi = rng.random(count) * 2 * np.pi
    sine = np.sqrt(1 - z**2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), side * z], axis=-1)


def mirror_normals(wi, wo):
    h = wi + wo
    return h / np.linalg.norm(h, axis=-1, keepdims=True)


@pytest.mark.parametrize("model", [m for m in CONSERVES_THE_VISIBLE_AREA if m not in SMITH[1:]])
@pytest.mark.parametrize("matrix", ["identity", "stretch", "shear", "condition 100"])
def test_table_3(model, matrix):
    M = MATRICES[matrix]
    d = ltmd.GGX(0.5).transformed(M)
    views = [direction(ANGLES[angle]) for angle in ("30", "60", "85")]
    result = np.array([visible_area_over_cosine(d, v, model, 0.5, M) for v in views])
    if CONSERVES_THE_VISIBLE_AREA[model]:
        np.testing.assert_allclose(result, 1, atol=1e-4)
    else:
        assert np.abs(result - 1).max() > 0.1


def test_smiths_joint_forms_share_one_masking(rng):
    d = ltmd.GGX(0.5, 0.2)
    v, m = directions(rng, 1000), d.sample(rng.random((1000, 2)))
    for model in SMITH:
        expected = np.where(np.sum(v * m, axis=1) > 0, d.G1(v), 0)
        # The same few operations in another order.
        np.testing.assert_allclose(ltmd.G1(d, v, m, model), expected, rtol=8 * np.finfo(float).eps)


def test_v_cavity_masking():
    """eq. 47 and 48: one facet of a pair faces away, or none is masked."""
    d = ltmd.GGX(0.5)
    v = direction(1.2)
    pair = np.array([direction(0.7), direction(0.7, 0.6 + np.pi)])
    masking = ltmd.G1(d, v, pair, "v_cavity")
    assert masking[1] == 0
    assert masking[0] / 2 * (pair[0] @ v) / pair[0, 2] == pytest.approx(v[2], rel=1e-14)
    steep = np.array([direction(0.2), direction(0.2, 0.6 + np.pi)])
    np.testing.assert_array_equal(ltmd.G1(d, v, steep, "v_cavity"), 1)


def test_joint_forms_are_their_equations(rng):
    d = ltmd.GGX(0.7, 0.2)
    wi, wo = directions(rng, 1000), directions(rng, 1000)
    m = mirror_normals(wi, wo)
    i, o = d.Lambda(wi), d.Lambda(wo)
    gi, go = 1 / (1 + i), 1 / (1 + o)
    phi = np.abs(np.arctan2(wi[:, 1], wi[:, 0]) - np.arctan2(wo[:, 1], wo[:, 0]))
    phi = np.minimum(phi, 2 * np.pi - phi)
    factor = 4.41 * phi / (4.41 * phi + 1)
    expected = {
        "separable": gi * go,
        "height_correlated": 1 / (1 + i + o),
        "direction_correlated": factor * gi * go + (1 - factor) * np.minimum(gi, go),
        "height_direction_correlated": 1 / (1 + np.maximum(i, o) + factor * np.minimum(i, o)),
        "v_cavity": np.minimum(
            1, 2 * m[:, 2] * np.minimum(wi[:, 2], wo[:, 2]) / np.sum(wi * m, axis=1)
        ),
        "implicit": wi[:, 2] * wo[:, 2],
        "kelemen": wi[:, 2] * wo[:, 2] / np.sum(wi * m, axis=1) ** 2,
    }
    for model, value in expected.items():
        np.testing.assert_allclose(ltmd.G2(d, wi, wo, m, model), value, rtol=1e-12)
        np.testing.assert_allclose(ltmd.G2(d, wi, wo, model=model), value, rtol=1e-12)
    assert set(expected) | {"schlick_smith"} == set(ltmd.MASKING_MODELS)


def test_order_of_the_joint_forms(rng):
    """Correlation only adds light: separable <= height-correlated <= both <= min G1."""
    d = ltmd.GGX(0.9)
    wi, wo = directions(rng, 10_000), directions(rng, 10_000)
    g = {model: ltmd.G2(d, wi, wo, model=model) for model in SMITH}
    top = np.minimum(d.G1(wi), d.G1(wo)) * (1 + 1e-14)
    assert np.all(g["separable"] <= g["height_correlated"])
    assert np.all(g["height_correlated"] <= g["height_direction_correlated"])
    assert np.all(g["separable"] <= g["direction_correlated"] * (1 + 1e-14))
    assert np.all(g["height_direction_correlated"] <= top)
    assert np.all(g["direction_correlated"] <= top)


def test_one_direction_twice_is_fully_correlated():
    d = ltmd.GGX(0.9)
    v = direction(1.3)
    for model in ("direction_correlated", "height_direction_correlated", "v_cavity"):
        assert ltmd.G2(d, v, v, v, model) == pytest.approx(ltmd.G1(d, v, v, model), rel=1e-14)


@pytest.mark.parametrize("model", ltmd.MASKING_MODELS)
def test_microfacets_that_face_away_are_not_seen(model):
    d = ltmd.GGX(0.5)
    wi, wo = direction(1.0, 0.0), direction(1.0, np.pi)
    m = direction(1.0, 0.0)
    assert m @ wo < 0
    assert ltmd.G1(d, wo, m, model) == 0
    assert ltmd.G2(d, wi, wo, m, model) == 0
    assert ltmd.G2(d, wo, wi, m, model) == 0
    horizon = np.array([1.0, 0.0, 0.0])
    assert ltmd.G2(d, wi, horizon, m, model) == 0
    assert ltmd.G2(d, wi, -wi, -m, model) == 0


def test_schlick_smith_on_a_gaussian_like_slope_scale():
    """k is twice the mean slope upwards; GGX's is alpha / 2, by its masking at the horizon."""
    d = ltmd.GGX(0.6, 0.2)
    for phi, alpha in ((0, 0.6), (np.pi / 2, 0.2)):
        v = direction(1.0, phi)
        k = alpha
        expected = v[2] / (v[2] * (1 - k) + k)
        assert ltmd.G1(d, v, v, "schlick_smith") == pytest.approx(expected, rel=1e-9)


def test_both_sides_of_the_surface(rng):
    d = ltmd.GGX(0.7, 0.3)
    wi, wo = directions(rng, 1000), directions(rng, 1000, side=-1)
    m = np.array([0.0, 0.0, 1.0])
    gi, go = d.G1(wi), d.G1(-wo)
    height = ltmd.G2(d, wi, wo, m, "height_correlated")
    expected = scipy.special.beta(1 / gi, 1 / go)
    np.testing.assert_allclose(height, expected, rtol=1e-11)
    np.testing.assert_array_equal(ltmd.G2(d, wi, wo, m, "height_direction_correlated"), height)
    for model in ("separable", "direction_correlated"):
        np.testing.assert_allclose(ltmd.G2(d, wi, wo, m, model), gi * go, rtol=1e-14)
    assert np.all(height <= gi * go)
    # V-cavities hide the foot of a facet from above and its top from below.
    steep = direction(0.9)
    v, w = direction(1.3), -direction(1.3)
    masked = ltmd.G1(d, v, steep, "v_cavity")
    assert ltmd.G2(d, v, w, steep, "v_cavity") == pytest.approx(max(0, 2 * masked - 1))
    # From below on both sides all is as from above.
    m = mirror_normals(wi, -wo)
    for model in ltmd.MASKING_MODELS:
        np.testing.assert_array_equal(ltmd.G2(d, -wi, wo, m, model), ltmd.G2(d, wi, -wo, m, model))


@pytest.mark.parametrize("model", ltmd.MASKING_MODELS)
def test_float32_over_all_of_the_range(model, rng):
    for alpha in (1e-6, 1e-3, 0.3, 1e3, 1e6):
        d = ltmd.GGX(alpha, 3 * alpha / (3 if alpha == 1e6 else 1))
        wi, wo = directions(rng, 10_000), directions(rng, 10_000)
        wi[:, 2] *= 10 ** rng.uniform(-8, 0, 10_000)
        wi /= np.linalg.norm(wi, axis=1, keepdims=True)
        wo[::2, 2] *= -1
        m = mirror_normals(wi, np.abs(wo))
        single = [a.astype(np.float32) for a in (wi, wo, m)]
        value = ltmd.G2(d, *single, model)
        assert value.dtype == np.float32
        assert np.all(np.isfinite(value)) and value.min() >= 0
        if model != "kelemen":
            assert value.max() <= 1 + 1e-6
        exact = ltmd.G2(d, *(a.astype(np.float64) for a in single), model)
        # Facets on edge may face the other way in the other precision.
        clear = np.abs(np.sum(wi * m, axis=1)) > 1e-2
        clear &= np.abs(np.sum(np.where(wo[:, 2:] < 0, -wo, wo) * m, axis=1)) > 1e-2
        # A difference of fractions: what V-cavities show to both sides.
        atol = 2e-7 if model == "v_cavity" else 1e-30
        np.testing.assert_allclose(value[clear], exact[clear], rtol=2e-5, atol=atol)


def test_an_unknown_model_is_refused_with_the_names():
    with pytest.raises(ValueError, match="'separable', .*not 'walter'"):
        ltmd.G2(ltmd.GGX(0.5), direction(0.1), direction(0.2), model="walter")
