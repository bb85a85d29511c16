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
    """Position and frame (along the tube, around it, out of it) where pixels see the knot."""
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
    normal = (np.cos(t)[..., None] * side[:, None] + np.sin(t)[..., None] * up[:, None]).reshape(
        -1, 3
    )
    along = np.repeat(along, t.shape[1], axis=0)
    position = np.repeat(centre(line), t.shape[1], axis=0) + 0.42 * normal
    # Pixels by the nearest point of a dense net.
    depth = CAMERA[2] - position[:, 2]
    pixel = np.floor((position[:, :2] / depth[:, None] * 2.1 + 0.5) * size).astype(int)
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
    """A way to sample where light comes from, given the distribution under M."""

    def __init__(self, d, name):
        self.d, self.name = d, name

    def sample(self, wo, u, choice):
        if self.name == "visible":
            return reflected(wo, self.d.sample_visible(wo, u))
        wi = reflected(wo, self.d.sample(u))
        if self.name == "mixed":
            sine = np.sqrt(1 - u[:, 0] ** 2)
            phi = 2 * np.pi * u[:, 1]
            uniform = np.stack([sine * np.cos(phi), sine * np.sin(phi), u[:, 0]], axis=-1)
            wi = np.where((choice < ALPHA)[:, None], uniform, wi)
        return wi

    def pdf(self, wo, wi):
        m = wi + wo
        m /= np.maximum(np.linalg.norm(m, axis=-1, keepdims=True), 1e-9)
        if self.name == "visible":
            density = self.d.pdf_visible(wo, m)
        else:
            density = self.d.pdf(m)
        density = density / (4 * np.maximum(np.sum(m * wo, axis=-1), 1e-6))
        if self.name == "mixed":
            density = ALPHA / (2 * np.pi) + (1 - ALPHA) * density
        return np.where(wi[:, 2] > 0, density, 0)


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

    total, square = np.zeros(len(position)), np.zeros(len(position))
    for _ in range(samples):
        world = light.sample(position, rng.random((len(position), 2)))
        wi = np.einsum("...ij,...j->...i", frame, world)
        value = (
            (light.radiance + ENVIRONMENT)
            * material(wi)
            / (light.pdf(position, world) + sampler.pdf(wo, wi))
        )
        wi = sampler.sample(wo, rng.random((len(position), 2)), rng.random(len(position)))
        world = np.einsum("...ji,...j->...i", frame, wi)
        hit = light.pdf(position, world)
        density = sampler.pdf(wo, wi) + hit
        radiance = np.where(hit > 0, light.radiance, 0) + ENVIRONMENT
        value += np.where(density > 0, radiance * material(wi) / np.maximum(density, 1e-12), 0)
        total += value
        square += value * value
    mean = total / samples
    return mean, np.maximum(square / samples - mean**2, 0) * samples / (samples - 1)


def samples_needed(variances, noise):
    return np.clip(variances / noise**2, FEWEST, MOST)


def noise_for(variances, average):
    """The standard error that takes `average` samples a pixel."""
    low, high = 1e-6, 1e2
    while high / low > 1 + 1e-6:
        middle = np.sqrt(low * high)
        if samples_needed(variances, middle).mean() > average:
            low = middle
        else:
            high = middle
    return high


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("torus_knot.png"))
    parser.add_argument("--size", type=int, default=160, help="pixels a side")
    parser.add_argument("--samples", type=int, default=64, help="samples to measure variance with")
    arguments = parser.parse_args()
    pixels, position, frame = knot(arguments.size)
    light = RectangularLight()
    names = {"D": "from D", "mixed": "from D and uniform", "visible": "visible normals"}
    table = {name: [] for name in names}
    pictures, noise = [], None
    for stretch in STRETCHES:
        d = ltmd.GTR(ALPHA, TAIL).transformed(ltmd.stretch_matrix(stretch))
        for name in names:
            rng = np.random.default_rng(0)
            mean, variances = variance(
                Sampler(d, name), light, position, frame, arguments.samples, rng
            )
            if noise is None:
                noise = noise_for(variances, PRINTED[stretch][0])
            table[name].append(samples_needed(variances, noise).mean())
        picture = np.full(arguments.size**2, np.nan)
        picture[pixels] = mean
        pictures.append(picture.reshape(arguments.size, arguments.size))

    print("average samples per pixel for the same noise (printed in the paper: D, mixed)")
    for i, stretch in enumerate(STRETCHES):
        row = ", ".join(f"{text} {table[name][i]:.0f}" for name, text in names.items())
        print(f"  s = {stretch:g}: {row}   ({PRINTED[stretch][0]}, {PRINTED[stretch][1]})")

    figure, axes = plt.subplots(
        1, len(STRETCHES) + 1, figsize=(13, 3), dpi=90, width_ratios=[1] * 4 + [1.5]
    )
    for axis, picture, stretch in zip(axes, pictures, STRETCHES, strict=False):
        shown = np.where(np.isnan(picture), 1, (1 - np.exp(-1.5 * picture)) ** (1 / 2.2))
        axis.imshow(shown, cmap="gray", vmin=0, vmax=1)
        axis.set_title(f"s = {stretch:g}")
        axis.axis("off")
    chart = axes[-1]
    where = np.arange(len(STRETCHES))
    for i, (name, text) in enumerate(names.items()):
        chart.bar(where + 0.27 * (i - 1), table[name], 0.25, label=text)
    for i in (0, 1):
        printed = [PRINTED[s][i] for s in STRETCHES]
        chart.plot(
            where + 0.27 * (i - 1),
            printed,
            "k_",
            markersize=11,
            label="printed" if i == 0 else None,
        )
    chart.set_xticks(where, [f"s = {s:g}" for s in STRETCHES])
    chart.set_ylabel("samples per pixel")
    chart.set_ylim(0, 210)
    chart.legend(fontsize=7, loc="upper left")
    figure.tight_layout(pad=0.5)
    figure.savefig(arguments.out)
    plt.close(figure)


if __name__ == "__main__":
    main()
