# SPDX-License-Identifier: Apache-2.0
"""A torus knot by every sampler of GTR: how many samples a pixel needs for the same noise.

    python examples/torus_knot.py --out torus_knot.png

Fig. 10 of microsurface-transformations in kind: roughness 0.3, tail 1, stretch s = 0, 0.25, 0.5 and
0.75, a rectangular light. Each pixel adds one sample of the light and one of the material, weighted
by the balance heuristic, until its standard error falls to a given level. That level is chosen so
that sampling from D takes the 95 samples that the paper prints for s = 0; all other numbers follow.
"""

import argparse
import pathlib

import ltmd
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ALPHA, TAIL = 0.3, 1.0
STRETCHES = (0.0, 0.25, 0.5, 0.75)
# Average samples per pixel, from D and from the mix with uniform sampling.
PRINTED = {0.0: (95, 84), 0.25: (91, 79), 0.5: (95, 89), 0.75: (131, 119)}
FEWEST, MOST = 16, 1024
CAMERA = np.array([0.0, 0.0, 12.0])
ENVIRONMENT = 0.05


class RectangularLight:
    corner = np.array([-1.5, 2.5, 5.0])
    edges = np.array([[3.0, 0.0, 0.0], [0.0, 2.0, -1.5]])
    radiance = 6.0

    def __init__(self):
        normal = np.cross(*self.edges)
        self.area = np.linalg.norm(normal)
        self.normal = normal / self.area

    def sample(self, position, u):
        to_light = self.corner + u @ self.edges - position
        return to_light / np.linalg.norm(to_light, axis=-1, keepdims=True)

    def pdf(self, position, direction):
        """Per steradian; 0 where the direction misses the light."""
        towards = direction @ self.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = ((self.corner - position) @ self.normal) / towards
            hit = position + distance[..., None] * direction - self.corner
            along = hit @ np.linalg.pinv(self.edges)
            inside = (distance > 0) & np.all((along >= 0) & (along <= 1), axis=-1)
            return np.where(inside, distance**2 / (self.area * np.abs(towards)), 0.0)


def knot(size):
    """Position and frame (along the tube, around it, out of it) at each pixel that sees the knot."""
    s, t = np.meshgrid(
        np.linspace(0, 2 * np.pi, 12 * size, endpoint=False),
        np.linspace(0, 2 * np.pi, 2 * size, endpoint=False),
        indexing="ij",
    )

    def centre(s):
        radius = 1.6 + 0.7 * np.cos(3 * s)
        return np.stack([radius * np.cos(2 * s), radius * np.sin(2 * s), 0.9 * np.sin(3 * s)], -1)

    line, step = s[:, 0], 1e-4
    along = (centre(line + step) - centre(line - step)) / (2 * step)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    side = np.cross(along, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(side, along)
    normal = (
        np.cos(t)[..., None] * side[:, None] + np.sin(t)[..., None] * up[:, None]
    ).reshape(-1, 3)
    along = np.repeat(along, t.shape[1], axis=0)
    position = np.repeat(centre(line), t.shape[1], axis=0) + 0.42 * normal
    # Pixels by the nearest point of a dense net.
    depth = CAMERA[2] - position[:, 2]
    pixel = np.floor((position[:, :2] / depth[:, None] * 3.9 * 0.5 + 0.5) * size).astype(int)
    seen = np.all((pixel >= 0) & (pixel < size), axis=1)
    order = np.flatnonzero(seen)[np.argsort(depth[seen])]
    index = (size - 1 - pixel[order, 1]) * size + pixel[order, 0]
    pixels, first = np.unique(index, return_index=True)
    chosen = order[first]
    frame = np.stack([along, np.cross(normal, along), normal], axis=-2)[chosen]
    return pixels, position[chosen], frame


def reflected(view, m):
    return 2 * np.sum(view * m, axis=-1, keepdims=True) * m - view


class Sampler:
    """A way to sample normals of a distribution under M."""

    def __init__(self, base, M, kind):
        self.d, self.base, self.M, self.kind = base.transformed(M), base, M, kind

    def to_base(self, view):
        w = np.concatenate([view[..., :2] @ np.linalg.inv(self.M).T, view[..., 2:]], axis=-1)
        return w / np.linalg.norm(w, axis=-1, keepdims=True)

    def sample(self, view, u):
        if self.kind == "D":
            return self.d.sample(u)
        if self.kind == "visible normals":
            return self.d.sample_visible(view, u)
        raise ValueError(self.kind)

    def pdf(self, view, m):
        if self.kind == "D":
            return self.d.pdf(m)
        return self.d.pdf_visible(view, m)


def variance(sampler, light, position, frame, samples, rng):
    """Mean and variance of one sample at each point."""
    view = CAMERA - position
    view /= np.linalg.norm(view, axis=-1, keepdims=True)
    wo = np.einsum("...ij,...j->...i", frame, view)
    wo[..., 2] = np.maximum(wo[..., 2], 1e-3)
    wo /= np.linalg.norm(wo, axis=-1, keepdims=True)

    def material(wi):
        up = np.maximum(wi[..., 2], 1e-6)
        lit = np.concatenate([wi[..., :2], up[..., None]], axis=-1)
        return np.where(wi[..., 2] > 0, ltmd.brdf(sampler.d, lit, wo) * up, 0)

    def material_pdf(wi):
        m = wi + wo
        m /= np.maximum(np.linalg.norm(m, axis=-1, keepdims=True), 1e-9)
        facing = np.maximum(np.sum(m * wo, axis=-1), 1e-6)
        return np.where(wi[..., 2] > 0, sampler.pdf(wo, m) / (4 * facing), 0)

    total, square = np.zeros(len(position)), np.zeros(len(position))
    for _ in range(samples):
        world = light.sample(position, rng.random((len(position), 2)))
        wi = np.einsum("...ij,...j->...i", frame, world)
        value = (
            (light.radiance + ENVIRONMENT)
            * material(wi)
            / (light.pdf(position, world) + material_pdf(wi))
        )
        m = sampler.sample(wo, rng.random((len(position), 2)))
        wi = reflected(wo, m)
        world = np.einsum("...ji,...j->...i", frame, wi)
        hit = light.pdf(position, world)
        density = material_pdf(wi) + hit
        radiance = np.where(hit > 0, light.radiance, 0) + ENVIRONMENT
        value += np.where(density > 0, radiance * material(wi) / np.maximum(density, 1e-12), 0)
        total += value
        square += value * value
    mean = total / samples
    return mean, np.maximum(square / samples - mean**2, 0) * samples / (samples - 1)
