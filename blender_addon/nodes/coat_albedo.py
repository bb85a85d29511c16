# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of Fresnel's factor over a rough dielectric coat: what Cycles keeps from the base.

By quadrature over the visible normals of a GGX lobe (Sampling the GGX distribution of visible
normals, Heitz 2018), when a group is made. Roughness moves the mean from the factor F at the
surface's normal towards F0; the share that is left of F - F0 hardly depends on the index of
refraction.
"""

import numpy as np

STEPS = 16
IOR = 1.5
GRID = 24  # samples squared


def fresnel(cosine, ior):
    """Of a dielectric."""
    g = np.sqrt(ior * ior - 1 + cosine * cosine)
    along = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1)
    return ((g - cosine) / (g + cosine)) ** 2 * (1 + along * along) / 2


def mean_fresnel(roughness, cosine):
    """Of all that a GGX lobe reflects."""
    alpha = max(roughness, 1e-3) ** 2
    u = (np.arange(GRID) + 0.5) / GRID
    u1, u2 = (a.ravel() for a in np.meshgrid(u, u))
    v = np.array([np.sqrt(1 - cosine * cosine), 0.0, cosine])
    w = v * (alpha, alpha, 1)
    w = w / np.linalg.norm(w)
    # A point of the disk, warped to the half that faces the viewer.
    t1, t2 = np.sqrt(u1) * np.cos(2 * np.pi * u2), np.sqrt(u1) * np.sin(2 * np.pi * u2)
    s = (1 + w[2]) / 2
    t2 = (1 - s) * np.sqrt(1 - t1 * t1) + s * t2
    x = np.array([0.0, 1.0, 0.0])
    y = np.cross(w, x)
    height = np.sqrt(np.maximum(0, 1 - t1 * t1 - t2 * t2))
    m = t1[:, None] * x + t2[:, None] * y + height[:, None] * w
    m = m * (alpha, alpha, 1)
    m /= np.linalg.norm(m, axis=1)[:, None]
    towards = np.clip(m @ v, 0, 1)
    out = 2 * towards * m[:, 2] - cosine  # z of the reflected direction

    def area(z):  # 1 + Lambda
        z = np.maximum(z, 1e-6)
        return (1 + np.sqrt(1 + alpha * alpha * (1 / (z * z) - 1))) / 2

    masking = np.where(out > 0, area(cosine) / (area(cosine) + area(out) - 1), 0)
    return np.sum(fresnel(towards, IOR) * masking) / np.sum(masking)


def share():
    """(mean - F0) / (F - F0) at even steps of [roughness, cosine]."""
    straight = fresnel(1.0, IOR)
    steps = np.linspace(0, 1, STEPS + 1)
    # Straight on the difference vanishes, and at the horizon the coat reflects as at 1 degree.
    cosines = np.clip(steps, 0.015, 0.85)
    table = [
        [(mean_fresnel(r, c) - straight) / (fresnel(c, IOR) - straight) for c in cosines]
        for r in steps
    ]
    return np.array(table)
