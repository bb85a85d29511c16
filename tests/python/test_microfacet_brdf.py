# SPDX-License-Identifier: Apache-2.0
"""Rough reflection and refraction: reciprocity, energy, and Mitsuba's plugins."""

import ltmd
import numpy as np
import pytest
from microfacet import MATRICES, direction
from test_masking import directions

ETA = 1.5
PHYSICAL = [m for m in ltmd.MASKING_MODELS if m not in ("implicit", "schlick_smith", "kelemen")]
each_model = pytest.mark.parametrize("model", ltmd.MASKING_MODELS)
each_physical_model = pytest.mark.parametrize("model", PHYSICAL)
UP = np.array([0.0, 0.0, 1.0])


def dielectric(cosine):
    return ltmd.fresnel_dielectric(cosine, ETA)


def hemisphere(side=1, count=240):
    """Directions and weights dwo |wo_z|, dense towards the horizon."""
    x, w = np.polynomial.legendre.leggauss(count)
    x, w = (x + 1) / 2, w / 2
    z, w = x**2, 2 * x * w
    phi = np.arange(count) * 2 * np.pi / count
    sine = np.sqrt(1 - z**2)[:, None]
    points = np.stack(
        [sine * np.cos(phi), sine * np.sin(phi), np.repeat(side * z[:, None], count, axis=1)],
        axis=-1,
    )
    return points, np.repeat((w * z)[:, None] * 2 * np.pi / count, count, axis=1)


def dot(a, b):
    return np.sum(a * b, axis=-1)


def visible_normals(d, v, count=300):
    """Visible normals, all of one weight."""
    u = (np.arange(count) + 0.5) / count
    return d.sample_visible(v, np.stack(np.meshgrid(u, u, indexing="ij"), axis=-1))


def refracted(v, m, eta):
    """v's refraction by the facets m to the other side, and where there is one."""
    ratio = 1 / eta if v[2] > 0 else eta
    cosine = m @ v if v[2] > 0 else -(m @ v)
    m = m if v[2] > 0 else -m
    square = 1 - ratio**2 * (1 - cosine**2)
    t = np.sqrt(np.maximum(square, 0))
    return (ratio * cosine - t)[..., None] * m - ratio * v, square > 0


@each_model
@pytest.mark.parametrize("matrix", MATRICES)
def test_reciprocity(model, matrix, rng):
    d = ltmd.GGX(0.4, 0.1).transformed(MATRICES[matrix])
    wi, wo = directions(rng, 2000), directions(rng, 2000)
    for side in (1, -1):
        forth = ltmd.brdf(d, side * wi, side * wo, dielectric, model)
        back = ltmd.brdf(d, side * wo, side * wi, dielectric, model)
        np.testing.assert_allclose(forth, back, rtol=1e-11)
    assert forth.max() > 0
    forth = ltmd.btdf(d, wi, -wo, ETA, model)
    back = ltmd.btdf(d, -wo, wi, ETA, model)
    # eta_i^2 f(wi, wo) = eta_o^2 f(wo, wi), as light is denser where the index is higher.
    np.testing.assert_allclose(forth, back * ETA**2, rtol=1e-6)
    assert forth.max() > 0


@each_physical_model
@pytest.mark.parametrize("alpha", [0.3, 1.0])
@pytest.mark.parametrize("angle", [0.0, 0.8, 1.4])
def test_albedo_of_mirrors_is_what_visible_normals_reflect(model, alpha, angle):
    d = ltmd.GGX(alpha)
    wi = direction(angle)
    wo, weight = hemisphere()
    albedo = np.sum(ltmd.brdf(d, wi, wo, model=model) * weight)
    assert albedo <= 1
    m = visible_normals(d, wi)
    o = 2 * (m @ wi)[..., None] * m - wi
    # Of the visible area of the facets m Smith's model sees G1(wi); the light that leaves sees G2.
    share = np.where(o[..., 2] > 0, ltmd.G2(d, wi, o, m, model), 0) / d.G1(wi)
    assert albedo == pytest.approx(share.mean(), abs=2e-3)


@each_physical_model
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("alpha", [0.3, 0.7])
@pytest.mark.parametrize("angle", [0.8, 1.4])
def test_albedo_of_a_dielectric_is_what_visible_normals_scatter(model, side, alpha, angle):
    d = ltmd.GGX(alpha)
    wi = side * direction(angle)
    above, weight = hemisphere(side)
    # D jumps to 0 where h_z changes its sign: a finer quadrature.
    below, fine = hemisphere(-side, 480)
    reflected = np.sum(ltmd.brdf(d, wi, above, dielectric, model) * weight)
    transmitted = np.sum(ltmd.btdf(d, wi, below, ETA, model) * fine)
    assert reflected + transmitted <= 1
    m = visible_normals(d, side * wi)
    cosine = m @ wi
    f = dielectric(cosine)
    masking = d.G1(side * wi)
    o = 2 * cosine[..., None] * m - wi
    share = np.where(side * o[..., 2] > 0, ltmd.G2(d, wi, o, m, model), 0) / masking
    assert reflected == pytest.approx((f * share).mean(), abs=2e-3)
    t, passes = refracted(wi, m, ETA)
    passes &= side * t[..., 2] < 0
    t[~passes] = -side * UP
    share = np.where(passes, ltmd.G2(d, wi, t, m, model), 0) / masking
    assert transmitted == pytest.approx(((1 - f) * share).mean(), abs=2e-3)


def test_smooth_limit():
    """Nearly smooth surfaces reflect what a smooth one does, and let the rest through."""
    d = ltmd.GGX(1e-3)
    wi = direction(0.7)
    m = visible_normals(d, wi, 200)
    f = dielectric(m @ wi)
    o = 2 * (m @ wi)[..., None] * m - wi
    value = ltmd.brdf(d, wi, o, dielectric) * o[..., 2]
    density = d.pdf_visible(wi, m) / (4 * m @ wi)
    assert (value / density).mean() == pytest.approx(dielectric(wi[2]), rel=1e-3)
    t, _ = refracted(wi, m, ETA)
    jacobian = ETA**2 * np.abs(dot(t, m)) / (m @ wi + ETA * dot(t, m)) ** 2
    value = ltmd.btdf(d, wi, t, ETA) * -t[..., 2]
    assert (value / (d.pdf_visible(wi, m) * jacobian)).mean() == pytest.approx(
        1 - f.mean(), rel=1e-3
    )


@pytest.mark.parametrize("matrix", ["identity", "shear"])
def test_fresnel_as_numbers_and_as_a_function(matrix, rng):
    d = ltmd.GGX(0.3).transformed(MATRICES[matrix])
    wi, wo = directions(rng, 100), directions(rng, 100)
    plain = ltmd.brdf(d, wi, wo)
    np.testing.assert_array_equal(ltmd.brdf(d, wi, wo, 0.5), plain * 0.5)
    h = wi + wo
    cosine = dot(wi, h) / np.linalg.norm(h, axis=1)
    expected = plain * ltmd.fresnel_conductor(cosine, 0.2, 3.9)
    given = ltmd.brdf(d, wi, wo, lambda c: ltmd.fresnel_conductor(c, 0.2, 3.9))
    np.testing.assert_allclose(given, expected, rtol=1e-13)
    # From below the cosine is negative: light meets the dielectric from inside.
    below = ltmd.brdf(d, -wi, -wo, dielectric)
    np.testing.assert_allclose(below, plain * dielectric(-cosine), rtol=1e-13)


def test_degenerate_directions():
    d = ltmd.GGX(0.3)
    horizon = np.array([1.0, 0.0, 0.0])
    for wi, wo in ((UP, -UP), (horizon, UP), (UP, horizon), (horizon, horizon)):
        assert ltmd.brdf(d, wi, wo) == 0
    for wi, wo in ((UP, UP), (horizon, UP), (UP, horizon), (-UP, -UP)):
        assert ltmd.btdf(d, wi, wo, ETA) == 0
    assert ltmd.btdf(d, UP, -UP, 1) == 0
    # No facet refracts light to where it came from.
    assert ltmd.btdf(d, direction(1.2, 0), -direction(1.2, np.pi), ETA) == 0
    with pytest.raises(ValueError, match="eta"):
        ltmd.btdf(d, UP, -UP, 0)


@each_model
def test_float32_has_no_holes(model, rng):
    for alpha in (1e-6, 0.01, 1.0, 1e6):
        d = ltmd.GGX(alpha)
        wi, wo = (directions(rng, 20_000).astype(np.float32) for _ in range(2))
        wi[:100] = wo[:100]
        wi[100:200, 2] = 1e-20
        for value in (
            ltmd.brdf(d, wi, wo, dielectric, model),
            ltmd.btdf(d, wi, -wo, ETA, model),
            ltmd.btdf(d, -wo, wi, ETA, model),
        ):
            assert value.dtype == np.float32
            assert np.all(np.isfinite(value)) and value.min() >= 0


@pytest.fixture(scope="module")
def mitsuba():
    module = pytest.importorskip("mitsuba")
    module.set_variant("scalar_rgb")
    return module


def mitsuba_values(mitsuba, description, wi, wo):
    bsdf = mitsuba.load_dict({"sample_visible": True, **description})
    context = mitsuba.BSDFContext()
    interaction = mitsuba.SurfaceInteraction3f()
    values = []
    for light, view in zip(wi, wo, strict=True):
        # Its wi is the view, and its values hold the cosine of the other direction.
        interaction.wi = mitsuba.Vector3f(view)
        values.append(bsdf.eval(context, interaction, mitsuba.Vector3f(light))[0] / abs(light[2]))
    return np.array(values)


@pytest.mark.parametrize("alpha", [(0.1, 0.1), (0.6, 0.6), (0.5, 0.15)])
def test_reflection_agrees_with_mitsuba(mitsuba, alpha, rng):
    wi, wo = directions(rng, 300), directions(rng, 300)
    description = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha_u": alpha[0],
        "alpha_v": alpha[1],
        "eta": {"type": "spectrum", "value": 0.2},
        "k": {"type": "spectrum", "value": 3.9},
    }
    ours = ltmd.brdf(
        ltmd.GGX(*alpha), wi, wo, lambda c: ltmd.fresnel_conductor(c, 0.2, 3.9), "separable"
    )
    theirs = mitsuba_values(mitsuba, description, wi, wo)
    np.testing.assert_allclose(theirs, ours, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("alpha", [(0.1, 0.1), (0.6, 0.6), (0.5, 0.15)])
def test_refraction_agrees_with_mitsuba(mitsuba, alpha, side, rng):
    wi, wo = side * directions(rng, 300), -side * directions(rng, 300)
    description = {
        "type": "roughdielectric",
        "distribution": "ggx",
        "alpha_u": alpha[0],
        "alpha_v": alpha[1],
        "int_ior": ETA,
        "ext_ior": 1.0,
    }
    d = ltmd.GGX(*alpha)
    ours = ltmd.btdf(d, wi, wo, ETA, "separable")
    theirs = mitsuba_values(mitsuba, description, wi, wo)
    assert np.count_nonzero(ours > 1e-3) > 20
    np.testing.assert_allclose(theirs, ours, rtol=1e-4, atol=1e-6)
    ours = ltmd.brdf(d, wi, -wo, dielectric, "separable")
    theirs = mitsuba_values(mitsuba, description, wi, -wo)
    np.testing.assert_allclose(theirs, ours, rtol=1e-4, atol=1e-9)
