# SPDX-License-Identifier: Apache-2.0
"""Judges for distributions: quadrature over slopes, chi-squared tests, and grids to test on.

Integrals run over the base's slopes t = M^T s in polar form about a centre, where a distribution
under M is as smooth as its base; the integrand is the distribution's own D at the normal of
s = M^-T t.
"""

import ltmd
import numpy as np
import scipy.stats

ROTATION = ltmd.material_matrix(0, 0.7, 0)
MATRICES = {
    "identity": np.eye(2),
    "stretch": np.diag([2.0, 0.5]),
    "shear": np.array([[1.0, 0.0], [2.0, 1.0]]),
    "rotation": ROTATION,
    "reflection": np.array([[-1.0, 0.3], [0.0, 1.2]]),
    "condition 100": ROTATION @ np.diag([10.0, 0.1]) @ ltmd.material_matrix(0, -0.2, 0),
}
ANGLES = {f"{degrees}": np.radians(degrees) for degrees in (0, 30, 60, 80, 85)}


def direction(theta, phi=0.6):
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def normals(slopes):
    m = np.concatenate([-slopes, np.ones_like(slopes[..., :1])], axis=-1)
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def panels(edges, order):
    """Gauss-Legendre nodes and weights on each interval between neighbours of `edges`."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    low, high = np.asarray(edges[:-1])[:, None], np.asarray(edges[1:])[:, None]
    return (
        ((low + high) / 2 + (high - low) / 2 * nodes).ravel(),
        ((high - low) / 2 * weights).ravel(),
    )


def facing_area(d, v, scale, M=None, centre=(0, 0), order=12, azimuths=96):
    """The integral of D(m) max(0, v.m) over normals, of a distribution that has been transformed by
    M; v need not be of length 1. `scale` is about the distance from `centre`, the base's mean
    slope, where its P22 halves."""
    M = np.eye(2) if M is None else M
    w = np.append(np.linalg.solve(M, v[:2]), v[2])
    w[2] -= w[:2] @ centre
    across = np.hypot(w[0], w[1])
    edges = np.log(scale) + np.linspace(-12, 18, 61)
    if across > 0:
        # From the radius w_z / |w_xy| on, some azimuths face away, or for w_z < 0 some face; the
        # border starts like a root.
        kink = np.log(abs(w[2]) / across)
        near = np.outer([-1, 1], 0.5 ** np.arange(1, 14)).ravel()
        edges = np.unique(np.concatenate([edges, kink + near, [kink]]))
    t, weight_t = panels(edges, order)
    radius = np.exp(t)
    start = np.zeros_like(radius)
    if across > 0:
        start = np.arccos(np.clip(w[2] / (radius * across), -1, 1))
    u, weight_u = panels(np.linspace(0, 1, 5), azimuths // 4)
    phi = np.arctan2(w[1], w[0]) + start[:, None] + u * (2 * np.pi - 2 * start)[:, None]
    base_slopes = radius[:, None, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    m = normals((base_slopes + centre) @ np.linalg.inv(M))
    # d slope = radius^2 dt dphi / |det M|; D dm = P22 / cos d slope.
    values = d.D(m) * m[..., 2] ** 3 * np.maximum(0, m @ v)
    per_radius = values @ weight_u * (2 * np.pi - 2 * start)
    return np.sum(per_radius * radius**2 * weight_t) / abs(np.linalg.det(M))


def furnace(d, v, scale, M=None, **options):
    """The weak white furnace: the integral of D(m) G1(v) max(0, v.m) / v_z, which is 1
    (masking-shadowing, eq. 22 for a specular surface)."""
    return facing_area(d, v, scale, M, **options) * d.G1(v) / v[2]


def chi_squared(
    normal_samples, pdf, scale, M=None, centre=(0, 0), radial=20, azimuthal=32, order=8
):
    """The p-value of samples against a density per steradian, pdf(m)."""
    M = np.eye(2) if M is None else M
    count = len(normal_samples)
    x, y, z = normal_samples.T
    with np.errstate(divide="ignore"):
        base_x = -(x * M[0, 0] + y * M[1, 0]) / z - centre[0]
        base_y = -(x * M[0, 1] + y * M[1, 1]) / z - centre[1]
    q = scale**2 / (scale**2 + base_x**2 + base_y**2)
    phi = np.arctan2(base_y, base_x) % (2 * np.pi)
    row = np.minimum((q * radial).astype(int), radial - 1)
    column = np.minimum((phi * (azimuthal / (2 * np.pi))).astype(int), azimuthal - 1)
    observed = np.bincount(row * azimuthal + column, minlength=radial * azimuthal)
    phis, phi_weights = panels(np.linspace(0, 2 * np.pi, azimuthal + 1), order)
    expected = np.empty((radial, azimuthal))
    for i in range(radial):
        edges = np.array([i, i + 1]) / radial
        if i == 0:
            edges = np.concatenate([[0], 1 / radial * 0.25 ** np.arange(24)[::-1]])
        qs, q_weights = panels(edges, order)
        r = scale * np.sqrt((1 - qs) / qs)
        t = r[:, None, None] * np.stack([np.cos(phis), np.sin(phis)], axis=-1)
        m = normals((t + centre) @ np.linalg.inv(M))
        density = pdf(m) * m[..., 2] ** 3 / abs(np.linalg.det(M))
        density = density * (scale**2 / 2 / qs**2)[:, None]
        cells = (density * phi_weights).reshape(len(qs), azimuthal, order).sum(axis=2)
        expected[i] = q_weights @ cells
    expected = count * expected.ravel()
    few = expected < 5
    f = np.append(expected[~few], expected[few].sum())
    o = np.append(observed[~few], observed[few].sum())
    if f[-1] < 5:
        f, o = np.append(f[:-2], f[-2] + f[-1]), np.append(o[:-2], o[-2] + o[-1])
    statistic = np.sum((o - f) ** 2 / f)
    return scipy.stats.chi2.sf(statistic, len(f) - 1)


def smallest_p(test_count):
    """The p-value below which one of `test_count` tests fails, 1 % for all of them (Sidak)."""
    return 1 - 0.99 ** (1 / test_count)
