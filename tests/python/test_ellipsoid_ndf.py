# SPDX-License-Identifier: Apache-2.0
"""The ellipsoid NDF, equation by equation (ellipsoid-ndf)."""

import ltmd
import numpy as np
import pytest
from microfacet import (
    ANGLES,
    MATRICES,
    chi_squared,
    direction,
    facing_area,
    panels,
    smallest_p,
)

N = np.array([0.0, 0.0, 1.0])
MIXED = np.array([[0.3, 0.1, 0.2], [-0.2, 0.5, 0.1], [0.1, -0.3, 1.1]])
SKEWED = {
    "tilted .3": ltmd.EllipsoidNDF.from_angles(0.25, 0.25, 0.3, 0, 0),
    "tilted and turned": ltmd.EllipsoidNDF.from_angles(0.2, 0.5, -0.2, 0.4, 1.0),
    "mixed": ltmd.EllipsoidNDF(MIXED),
    "tall": ltmd.EllipsoidNDF.from_angles(3, 1.5, 0.3, 0.2, 0),
}
# Also views from which the mesosurface faces away.
AZIMUTHS = (0.6, 2.2, 3.7, 5.3)
each_skewed = pytest.mark.parametrize("name", SKEWED)


def upper_normals(rng, count):
    m = rng.normal(size=(count, 3))
    m[:, 2] = np.abs(m[:, 2])
    return m / np.linalg.norm(m, axis=1, keepdims=True)


def norm(a):
    return np.linalg.norm(a, axis=-1)


def dot(a, b):
    return np.sum(a * b, axis=-1)


def slope_scale(d, M=None):
    """(scale, centre) for the quadrature over slopes of d, in the base's slopes under M."""
    a = d.A / norm(d.A @ N)
    s = a.T @ a
    sigma = s[:2, :2] - np.outer(s[:2, 2], s[:2, 2])
    return np.linalg.det(sigma) ** 0.25, np.array(d.mean_slope)


@each_skewed
def test_d(name, rng):
    d = SKEWED[name]
    m = upper_normals(rng, 1000)
    stretched = norm(m @ np.linalg.inv(d.A))  # |A^-T m|
    expected = 1 / (np.pi * abs(np.linalg.det(d.A)) * norm(d.A @ N) * stretched**4)  # eq. 1
    np.testing.assert_allclose(d.D(m), expected, rtol=1e-12)
    assert np.all(d.D(m * [1, 1, -1]) == 0)
    k = d.gaussian_curvature(m) * d.ellipsoid_area(N)  # eq. 9
    np.testing.assert_allclose(d.D(m), 1 / k, rtol=1e-12)
    slopes = -m[:, :2] / m[:, 2:]
    np.testing.assert_allclose(d.P22(slopes), expected * m[:, 2] ** 4, rtol=1e-12)


def test_from_angles():
    x, y, z = 0.3, -0.5, 1.2
    c, s = np.cos, np.sin
    turns = (
        np.array([[1, 0, 0], [0, c(x), -s(x)], [0, s(x), c(x)]])
        @ np.array([[c(y), 0, s(y)], [0, 1, 0], [-s(y), 0, c(y)]])
        @ np.array([[c(z), -s(z), 0], [s(z), c(z), 0], [0, 0, 1]])
    )  # eq. 3
    d = ltmd.EllipsoidNDF.from_angles(0.2, 0.4, x, y, z)
    np.testing.assert_allclose(d.A, np.diag([0.2, 0.4, 1]) @ turns, rtol=0, atol=1e-15)


def test_theta_z_turns_the_axes_by_minus_theta_z(rng):
    m = upper_normals(rng, 1000)
    turned = ltmd.EllipsoidNDF.from_angles(0.5, 0.1, theta_z=0.4)
    ggx = ltmd.GGX(0.5, 0.1).transformed(ltmd.material_matrix(0, -0.4, 0))
    np.testing.assert_allclose(turned.D(m), ggx.D(m), rtol=1e-12)
    np.testing.assert_allclose(turned.Lambda(m), ggx.Lambda(m), rtol=1e-12)
    # The rough axis, U of the ellipsoid, lies at -0.4.
    assert turned.P22([0.3 * np.cos(0.4), -0.3 * np.sin(0.4)]) > turned.P22([0.3, 0])


@pytest.mark.parametrize(
    ("angles", "tip"),
    [
        ((0.3, 0, 0), [0, np.sin(0.3), np.cos(0.3)]),
        ((0, 0.3, 0), [-np.sin(0.3), 0, np.cos(0.3)]),
        # Turned by -theta_z with the rest.
        ((0.3, 0, np.pi / 2), [np.sin(0.3), 0, np.cos(0.3)]),
    ],
)
def test_theta_x_and_theta_y_tip_the_peak(angles, tip, rng):
    d = ltmd.EllipsoidNDF.from_angles(0.1, 0.2, *angles)
    near = np.array(tip) + 0.02 * rng.normal(size=(1000, 3))
    assert np.all(d.D(near / norm(near)[:, None]) < d.D(tip) * (1 + 1e-15))


@each_skewed
def test_masking(name, rng):
    d = SKEWED[name]
    u = upper_normals(rng, 1000)
    au, an = u @ d.A.T, d.A @ N
    ratio = 2 * norm(an) ** 2 * u[:, 2] / (norm(au) * norm(an) + au @ an)  # eq. 6
    np.testing.assert_allclose(d.unclamped_G1(u), ratio, rtol=1e-12)
    np.testing.assert_allclose(d.G1(u), np.minimum(1, ratio), rtol=1e-12)
    np.testing.assert_allclose(d.Lambda(u), 1 / np.minimum(1, ratio) - 1, rtol=1e-9, atol=1e-12)
    assert np.any(ratio > 1)
    assert np.all(d.unclamped_G1(u * [1, 1, -1]) == 0)
    np.testing.assert_allclose(
        d.projected_area(u), d.lune_area(u, N) / d.ellipsoid_area(N), rtol=1e-10
    )  # eq. 28 over eq. 26


def test_the_unclamped_masking_exceeds_one():
    """At theta_o = -40 degrees Lambda without the min would be negative."""
    v = direction(np.radians(-40), np.pi / 2)
    d = ltmd.EllipsoidNDF.from_angles(0.5, 0.5, 0.3)
    assert 1 / d.unclamped_G1(v) - 1 == pytest.approx(-0.13207, abs=5e-6)
    assert d.Lambda(v) == 0
    assert d.G1(v) == 1


@each_skewed
@pytest.mark.parametrize("matrix", MATRICES)
def test_normalisation_and_furnace(name, matrix):
    base, M = SKEWED[name], MATRICES[matrix]
    d = base.transformed(M)
    scale, centre = slope_scale(base)
    assert facing_area(d, N, scale, M, centre) == pytest.approx(1, abs=1e-6)
    below = []
    for angle in ANGLES.values():
        for phi in AZIMUTHS:
            v = direction(angle, phi)
            area = facing_area(d, v, scale, M, centre)
            assert area == pytest.approx(d.projected_area(v), rel=1e-6)
            assert area * d.G1(v) == pytest.approx(min(v[2], area), rel=1e-6)  # eq. 31, 32
            assert area * d.unclamped_G1(v) == pytest.approx(v[2], abs=1e-6)
            below.append(area < v[2])
    assert any(below)


def boundary_of_lune(d, u, v, order=64):
    """Points on |A p| = 1, their normals times areas, and weights, over the lune of u and v: a
    polar grid of the sphere A p whose meridians are the lune's borders."""
    au, av = d.A @ u, d.A @ v
    pole = np.cross(au, av)
    pole = pole if norm(pole) > 1e-9 else np.cross(au, [1.0, 0.3, 0.2])
    pole, x = pole / norm(pole), au / norm(au)
    y = np.cross(pole, x)
    angle = np.arctan2(av @ y, av @ x)
    phi, phi_weight = panels([angle - np.pi / 2, np.pi / 2], order)
    theta, theta_weight = panels([0, np.pi], order)
    p_phi, p_theta = np.meshgrid(phi, theta, indexing="ij")
    c, s = np.cos(p_phi)[..., None], np.sin(p_phi)[..., None]
    ct, st = np.cos(p_theta)[..., None], np.sin(p_theta)[..., None]
    inverse = np.linalg.inv(d.A).T
    points = (st * c * x + st * s * y + ct * pole) @ inverse
    along_theta = (ct * c * x + ct * s * y - st * pole) @ inverse
    along_phi = (-st * s * x + st * c * y) @ inverse
    area = np.cross(along_theta, along_phi)
    gradient = points @ (d.A.T @ d.A)
    assert np.allclose(np.cross(area, gradient), 0, atol=1e-9)
    m = gradient / norm(gradient)[..., None]
    return points, m, norm(area) * phi_weight[:, None] * theta_weight


@each_skewed
def test_projected_areas(name):
    d = SKEWED[name]
    for u in (N, direction(0.9, 2.0), np.array([0.6, 0.0, -0.8])):
        _, m, area = boundary_of_lune(d, u, u)
        assert np.sum(m @ u * area) == pytest.approx(d.ellipsoid_area(u), rel=1e-9)  # eq. 21, 26
        assert d.ellipsoid_area(2 * u, 3.0) == pytest.approx(18 * d.ellipsoid_area(u), rel=1e-14)
        for v in (N, direction(1.4, 4.0)):
            _, m, area = boundary_of_lune(d, u, v)
            assert np.min(m @ u) > -1e-12 and np.min(m @ v) > -1e-12
            assert np.sum(m @ u * area) == pytest.approx(d.lune_area(u, v), rel=1e-9)  # eq. 27, 28
        assert d.lune_area(u, u) == pytest.approx(d.ellipsoid_area(u), rel=1e-14)
        assert d.lune_area(u, N, 0.5) == pytest.approx(d.lune_area(u, N) / 4, rel=1e-14)
    assert d.ellipsoid_area(N, d.unit_size) == pytest.approx(1, rel=1e-14)  # eq. 29


@each_skewed
def test_gaussian_curvature(name):
    d = SKEWED[name]
    axes, turn = np.linalg.svd(d.A)[1:]
    total = 0.0
    for u in (N, -N):
        points, m, area = boundary_of_lune(d, u, u, order=160)
        curvature = d.gaussian_curvature(m)
        # x^2/a^2 + y^2/b^2 + z^2/c^2 = 1: K = (a b c (x^2/a^4 + y^2/b^4 + z^2/c^4))^-2.
        sums = np.sum((points @ turn.T) ** 2 * axes**4, axis=-1)
        np.testing.assert_allclose(curvature, (np.prod(axes) / sums) ** 2, rtol=1e-9)  # eq. 20
        total += np.sum(curvature * area)
    assert total == pytest.approx(4 * np.pi, rel=1e-6)  # Gauss and Bonnet
    np.testing.assert_allclose(d.gaussian_curvature(m, 2.0), curvature / 4, rtol=1e-14)


@each_skewed
def test_mean_normal(name):
    """The integral of the half ellipsoid's normals over its area is along A^T A n (section 5.1)."""
    d = SKEWED[name]
    _, m, area = boundary_of_lune(d, N, N)
    mean = np.einsum("ij,ijk->k", area, m)
    np.testing.assert_allclose(mean / norm(mean), d.mean_normal, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        -d.mean_normal[:2] / d.mean_normal[2], d.mean_slope, rtol=1e-12, atol=1e-15
    )
    expected = d.A.T @ d.A @ N
    np.testing.assert_allclose(d.mean_normal, expected / norm(expected), rtol=0, atol=1e-14)


def test_scaled_and_turned_matrices_are_the_same(rng):
    m, u = upper_normals(rng, 1000), rng.random((1000, 2))
    d = ltmd.EllipsoidNDF(MIXED)
    for _ in range(5):
        q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        same = ltmd.EllipsoidNDF(rng.normal() * q @ MIXED)
        np.testing.assert_allclose(same.D(m), d.D(m), rtol=1e-12)
        np.testing.assert_allclose(same.G1(m), d.G1(m), rtol=1e-12)
        np.testing.assert_allclose(same.sample_visible(m, u), d.sample_visible(m, u), atol=1e-7)


@each_skewed
def test_sggx_matrix(name, rng):
    d = SKEWED[name]
    m = upper_normals(rng, 1000)
    s = d.sggx_matrix
    np.testing.assert_allclose(s, d.A.T @ d.A, rtol=1e-14, atol=1e-15)
    back = ltmd.EllipsoidNDF.from_sggx(s)
    np.testing.assert_allclose(back.sggx_matrix, s, rtol=0, atol=1e-14 * norm(s).max())
    np.testing.assert_allclose(back.D(m), d.D(m), rtol=1e-12)
    # SGGX's D of microflakes, whose projected area along n is (n^T S n)^(1/2).
    flakes = 1 / (
        np.pi * np.sqrt(np.linalg.det(s)) * np.einsum("ij,jk,ik->i", m, np.linalg.inv(s), m) ** 2
    )
    np.testing.assert_allclose(d.D(m), flakes / np.sqrt(s[2, 2]), rtol=1e-12)


@each_skewed
@pytest.mark.parametrize("matrix", MATRICES)
def test_under_a_map_it_stays_an_ellipsoid(name, matrix, rng):
    base, M = SKEWED[name], MATRICES[matrix]
    d = base.transformed(M)
    lifted = np.eye(3)
    lifted[:2, :2] = np.linalg.inv(M)
    np.testing.assert_allclose(d.A, base.A @ lifted, rtol=0, atol=1e-14 * np.abs(d.A).max())
    m = upper_normals(rng, 1000)
    turned = np.column_stack([m[:, :2] @ M, m[:, 2]])  # eq. 13, 22 of microsurface-transformations
    size = norm(turned)
    expected = abs(np.linalg.det(M)) * base.D(turned / size[:, None]) / size**4
    np.testing.assert_allclose(d.D(m), expected, rtol=1e-12)
    v = np.column_stack([m[:, :2] @ np.linalg.inv(M).T, m[:, 2]])
    np.testing.assert_allclose(d.projected_area(m), base.projected_area(v), rtol=1e-10)
    np.testing.assert_allclose(d.Lambda(m), base.Lambda(v), rtol=1e-9, atol=1e-12)


@each_skewed
def test_is_a_non_centred_ggx_over_slopes(name, rng):
    d = SKEWED[name]
    s = d.A.T @ d.A
    s /= s[2, 2]
    sigma = s[:2, :2] - np.outer(s[:2, 2], s[:2, 2])
    slopes = rng.standard_cauchy((1000, 2))
    offset = slopes - d.mean_slope
    q = np.einsum("ij,jk,ik->i", offset, np.linalg.inv(sigma), offset)
    expected = 1 / (np.pi * np.sqrt(np.linalg.det(sigma)) * (1 + q) ** 2)
    np.testing.assert_allclose(d.P22(slopes), expected, rtol=1e-12)
    values, vectors = np.linalg.eigh(sigma)
    ggx = ltmd.GGX(1.0).transformed(vectors @ np.diag(values**-0.5) @ vectors.T)
    moved = ggx.sheared(*d.mean_slope)
    m = upper_normals(rng, 1000)
    np.testing.assert_allclose(d.D(m), moved.D(m), rtol=1e-12)
    np.testing.assert_allclose(d.Lambda(m), moved.Lambda(m), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(d.projected_area(m), moved.projected_area(m), rtol=1e-9)
    again = ltmd.EllipsoidNDF.from_angles(0.2, 0.2).transformed(np.diag([1, 0.5]))
    np.testing.assert_allclose(
        again.sheared(0.2, 0.4).D(m), ltmd.GGX(0.2, 0.4).sheared(0.2, 0.4).D(m), rtol=1e-12
    )


def disk(u):
    """Points of the unit disk (eq. 34-37)."""
    a, b = 2 * u[:, 0] - 1, 2 * u[:, 1] - 1
    wide = np.abs(a) > np.abs(b)
    x = np.where(wide, a * np.cos(np.pi * b / (4 * a)), b * np.sin(np.pi * a / (4 * b)))
    y = np.where(wide, a * np.sin(np.pi * b / (4 * a)), b * np.cos(np.pi * a / (4 * b)))
    return x, y


def unit(a):
    return a / norm(a)[..., None]


def five_steps(d, v, u):
    """Section 4.1 as printed, det A > 0; the point on the ellipsoid of step d is A^-1 p_c."""
    x_a, y_b = disk(u)
    av, an = d.A @ v, d.A @ N
    s = (1 + av @ an / (norm(av) * norm(an))) / 2  # eq. 38
    x_b = s * x_a + (1 - s) * np.sqrt(1 - y_b**2)
    z_b = np.sqrt(np.maximum(0, 1 - x_b**2 - y_b**2))
    e3 = unit(av)
    e2 = unit(np.cross(av, an))
    np.testing.assert_allclose(e2, unit(np.linalg.inv(d.A).T @ np.cross(v, N)), atol=1e-12)  # 43
    e1 = np.cross(e2, e3)
    p_c = x_b[:, None] * e1 + y_b[:, None] * e2 + z_b[:, None] * e3
    on_ellipsoid = p_c @ np.linalg.inv(d.A).T
    normal = unit(p_c @ d.A)  # eq. 46
    np.testing.assert_allclose(normal, unit(on_ellipsoid @ (d.A.T @ d.A)), atol=1e-9)  # eq. 22
    return normal


@each_skewed
def test_five_steps(name, rng):
    d = SKEWED[name]
    assert np.linalg.det(d.A) > 0
    u = rng.random((1000, 2))
    for angle in (0.4, 1.0, 1.5):
        for phi in AZIMUTHS:
            v = direction(angle, phi)
            m = d.sample_visible(v, u)
            # As printed, z_b and m_z are small differences near the lune's borders.
            np.testing.assert_allclose(m, five_steps(d, v, u), rtol=0, atol=1e-6)
            assert np.all(m[:, 2] >= 0)
    np.testing.assert_allclose(d.sample(u), d.sample_visible(N, u), rtol=0, atol=1e-14)


def bounding_sphere_rays(d, v, rng, count):
    """Version 1 of section 4: rays along -v through the silhouette of a sphere around |A p| = 1."""
    radius = 1 / np.linalg.svd(d.A)[1].min()
    e1 = unit(np.cross(v, [0.31, 0.95, 0.02]))
    e2 = np.cross(v, e1)
    found = []
    while sum(map(len, found)) < count:
        x, y = disk(rng.random((count, 2)))
        start = radius * (x[:, None] * e1 + y[:, None] * e2)
        a_start, a_v = start @ d.A.T, d.A @ v
        b, a = a_start @ a_v, a_v @ a_v
        inside = b**2 - a * (dot(a_start, a_start) - 1)
        hit = inside >= 0
        t = (-b[hit] + np.sqrt(inside[hit])) / a  # the side toward v
        m = unit((start[hit] + t[:, None] * v) @ (d.A.T @ d.A))
        found.append(m[m[:, 2] >= 0])
    return np.concatenate(found)[:count]


def silhouette_rays(d, v, rng, count):
    """Version 2: points of the ellipsoid over its own silhouette."""
    e3 = unit(d.A @ v)
    e1 = unit(np.cross(e3, [0.31, 0.95, 0.02]))
    e2 = np.cross(e3, e1)
    found = []
    while sum(map(len, found)) < count:
        x, y = disk(rng.random((count, 2)))
        z = np.sqrt(np.maximum(0, 1 - x**2 - y**2))
        p_o = x[:, None] * e1 + y[:, None] * e2 + z[:, None] * e3
        m = unit(p_o @ d.A)
        found.append(m[m[:, 2] >= 0])
    return np.concatenate(found)[:count]


def version_3(d, v, rng, count):
    return d.sample_visible(v, rng.random((count, 2)))


@pytest.mark.parametrize("sampler", [bounding_sphere_rays, silhouette_rays, version_3])
@each_skewed
def test_all_versions_sample_the_visible_normals(sampler, name, rng):
    d = SKEWED[name]
    scale, centre = slope_scale(d)
    limit = smallest_p(3 * len(SKEWED) * 2)
    for phi in AZIMUTHS[::2]:
        v = direction(1.2, phi)
        m = sampler(d, v, rng, 50_000)
        ratio = d.ellipsoid_area(N) / d.lune_area(v, N)

        def pdf(n, v=v, ratio=ratio):
            return ratio * d.D(n) * np.maximum(0, n @ v)  # eq. 33

        np.testing.assert_allclose(d.pdf_visible(v, m), pdf(m), rtol=1e-9)
        assert chi_squared(m, pdf, scale, None, centre) > limit


@each_skewed
@pytest.mark.parametrize("matrix", MATRICES)
def test_samples_follow_their_density(name, matrix, rng):
    base, M = SKEWED[name], MATRICES[matrix]
    d = base.transformed(M)
    scale, centre = slope_scale(base)
    limit = smallest_p(len(SKEWED) * len(MATRICES) * (1 + len(ANGLES)))
    m = d.sample(rng.random((200_000, 2)))
    assert np.all(m[:, 2] >= 0)
    assert chi_squared(m, d.pdf, scale, M, centre) > limit
    for angle, phi in zip(ANGLES.values(), np.resize(AZIMUTHS, len(ANGLES)), strict=True):
        v = direction(angle, phi)
        m = d.sample_visible(v, rng.random((200_000, 2)))
        assert np.all(m[:, 2] >= 0)
        assert chi_squared(m, lambda n, v=v: d.pdf_visible(v, n), scale, M, centre) > limit


@each_skewed
def test_reflected_directions(name, rng):
    """Their density (eq. 48) over the whole sphere, and the weights' bound (eq. 49-52)."""
    d = SKEWED[name]
    v = direction(0.7, 2.5)
    count = 200_000
    m = d.sample_visible(v, rng.random((count, 2)))
    out = 2 * (m @ v)[:, None] * m - v  # eq. 47

    def density(w):
        h = unit(v + w)
        return d.ellipsoid_area(N) / (4 * d.lune_area(v, N)) * d.D(h)

    np.testing.assert_allclose(density(out), d.pdf_visible(v, m) / (4 * m @ v), rtol=1e-6)
    rows, columns, order = 12, 24, 12
    # The half vector is at the horizon for w_z = -v_z.
    assert out[:, 2].min() >= -v[2] - 1e-15
    z_edges, phi_edges = np.linspace(-v[2], 1, rows + 1), np.linspace(-np.pi, np.pi, columns + 1)
    z, z_weight = panels(z_edges, order)
    phi, phi_weight = panels(phi_edges, order)
    r = np.sqrt(1 - z**2)[:, None]
    w = np.stack(
        [r * np.cos(phi), r * np.sin(phi), np.broadcast_to(z[:, None], (len(z), len(phi)))], axis=-1
    )
    cells = density(w) * z_weight[:, None] * phi_weight
    expected = cells.reshape(rows, order, columns, order).sum(axis=(1, 3))
    assert expected.sum() == pytest.approx(1, abs=1e-4)
    azimuth = np.arctan2(out[:, 1], out[:, 0])
    observed = np.histogram2d(out[:, 2], azimuth, (z_edges, phi_edges))[0]
    deviation = (observed - count * expected) / np.sqrt(count * expected + 1)
    assert np.abs(deviation).max() < 5

    up = out[:, 2] > 0
    brdf = d.D(m) * d.G1(v) * d.G1(out) / (4 * v[2] * np.abs(out[:, 2]))  # eq. 4
    smith = ltmd.brdf(d, np.broadcast_to(v, out.shape).copy(), out, model="separable")
    np.testing.assert_allclose(smith[up], brdf[up], rtol=1e-6)
    weight = (brdf * np.abs(out[:, 2]) / density(out))[up]  # eq. 49
    assert np.all(weight <= d.G1(out[up]) * (1 + 1e-6))
    expected_weight = d.G1(v) * d.G1(out[up]) / v[2] * d.lune_area(v, N) / d.ellipsoid_area(N)
    np.testing.assert_allclose(weight, expected_weight, rtol=1e-6)  # eq. 50


def test_weights_of_a_centred_ellipsoid_are_g1(rng):
    d = ltmd.EllipsoidNDF.from_angles(0.3, 0.7, theta_z=0.5)
    v = direction(1.3, 2.0)
    assert d.G1(v) / v[2] * d.projected_area(v) == pytest.approx(1, rel=1e-14)


@each_skewed
def test_single_precision(name, rng):
    d = SKEWED[name]
    eps = np.finfo(np.float32).eps
    v = np.concatenate(
        [upper_normals(rng, 1000), [direction(np.pi / 2 - 1e-5, p) for p in AZIMUTHS]]
    )
    single = v.astype(np.float32)
    v = single.astype(float)
    k = np.linalg.svd(d.A / norm(d.A @ N))[1]
    rounding = 40 * eps * k.max() / k.min()
    np.testing.assert_allclose(d.D(single), d.D(v), rtol=rounding)
    np.testing.assert_allclose(d.projected_area(single), d.projected_area(v), rtol=rounding)
    np.testing.assert_allclose(1 + d.Lambda(single), 1 + d.Lambda(v), rtol=rounding / v[-1, 2])
    u = rng.random((len(v), 2)).astype(np.float32)
    m, exact = d.sample_visible(single, u), d.sample_visible(v, u.astype(float))
    assert np.all(m[:, 2] >= 0)
    assert np.abs(m - exact).max() < np.sqrt(rounding)


def test_refusals_name_what_was_given():
    with pytest.raises(ValueError, match=r"A is \(\(1, 2, 3\), .* condition"):
        ltmd.EllipsoidNDF([[1, 2, 3], [2, 4, 6], [0, 0, 1]])
    with pytest.raises(ValueError, match=r"must have shape \(3, 3\), not \(2, 2\)"):
        ltmd.EllipsoidNDF(np.eye(2))
    with pytest.raises(TypeError, match="numbers"):
        ltmd.EllipsoidNDF("A")
    with pytest.raises(ValueError, match="alpha_x is 0; it must be in"):
        ltmd.EllipsoidNDF.from_angles(0, 1)
    with pytest.raises(ValueError, match="finite"):
        ltmd.EllipsoidNDF.from_angles(1, 1, np.inf)
    with pytest.raises(ValueError, match="symmetric"):
        ltmd.EllipsoidNDF.from_sggx([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]])
    with pytest.raises(ValueError, match="positive definite"):
        ltmd.EllipsoidNDF.from_sggx(np.diag([1, -1, 1]))
    with pytest.raises(ValueError, match="invertible"):
        ltmd.EllipsoidNDF(MIXED).transformed([[1, 2], [2, 4]])
