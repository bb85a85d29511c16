# SPDX-License-Identifier: Apache-2.0
"""A light that depends on direction alone, and what a surface of a distribution makes of it."""

import numpy as np

# Red is white all around (the furnace), green a soft lamp, blue a gradient; in world space.
LAMP = np.array([0.48, 0.6, 0.64])
LAMP_POWER = 6
LAMP_STRENGTH = 4
GRADIENT = np.array([-0.5, 0.7, 0.3])


def radiance(directions):
    """The light from world directions, [..., 3]."""
    lamp = np.maximum(0, directions @ LAMP) ** LAMP_POWER
    return np.stack([np.ones_like(lamp), LAMP_STRENGTH * lamp, 1 + directions @ GRADIENT], axis=-1)


def to_world(view):
    """The rotation of a surface's frame (X, Y, normal) that takes the view direction to +Z."""
    x = np.cross((0.2, 0.9, 0.1), view)
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(view, x), view])


def hemisphere(order):
    """Directions above the surface, and their weights in an integral over solid angles."""
    x, w = np.polynomial.legendre.leggauss(order)
    theta = np.pi / 4 * (x + 1)
    phi = np.pi / order * np.arange(2 * order)
    w = np.outer(np.pi / 4 * w * np.sin(theta), np.full(2 * order, np.pi / order)).ravel()
    t, p = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1), w


def seen(view, scattered, order=120, below=False):
    """The light of radiance() that scattered(directions) of a surface sends to `view`.

    scattered: the BSDF at each direction of the light, in the surface's frame; below: on the other
    side.
    """
    directions, weights = hemisphere(order)
    if below != (view[2] < 0):
        directions = directions * (1, 1, -1)
    weights = weights * np.abs(directions[:, 2]) * scattered(directions)
    return weights @ radiance(directions @ to_world(view).T)


def polar(theta, phi):
    """Unit vectors at angles in degrees from the normal and from X."""
    t, p = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)
