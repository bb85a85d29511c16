# SPDX-License-Identifier: Apache-2.0
"""Centred, turned and skewed ellipsoids: their slopes, their normals, and spheres they cover.

    python examples/ellipsoid_ndf.py --out ellipsoid.png

A skewed ellipsoid (ellipsoid-ndf) moves the highlight, without a normal map's breach of energy.
"""

import argparse
import pathlib

import ltmd
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ELLIPSOIDS = {
    "round\nα .25": ltmd.EllipsoidNDF.from_angles(0.25, 0.25),
    "turned\nα .5, .12, θz −35°": ltmd.EllipsoidNDF.from_angles(0.5, 0.12, theta_z=-np.radians(35)),
    "skewed\nα .25, θx 20°": ltmd.EllipsoidNDF.from_angles(0.25, 0.25, theta_x=np.radians(20)),
    "all of it\nα .5, .12, θ 10° 20° −35°": ltmd.EllipsoidNDF.from_angles(
        0.5, 0.12, *np.radians([10, 20, -35])
    ),
}
SAMPLES = 400
LIGHT = np.array([0.35, 0.45, 0.82])


def unit(a):
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


def slopes_of(m):
    return -m[..., :2] / m[..., 2:]


def show_slopes(axes, d, u):
    """log10 of P22 relative to its peak, with sampled slopes."""
    extent = 1.5
    grid = np.linspace(-extent, extent, 241)
    slopes = np.stack(np.meshgrid(grid, grid), axis=-1)
    density = np.log10(d.P22(slopes))
    axes.contourf(grid, grid, density - density.max(), np.linspace(-3, 0, 13), cmap="viridis")
    axes.contour(grid, grid, density - density.max(), [-2, -1], colors="w", linewidths=0.4)
    x, y = slopes_of(d.sample(u)).T
    axes.plot(x, y, ".", color="w", markersize=1.6, markeredgewidth=0)
    axes.plot(*d.mean_slope, "+", color="r", markersize=9)
    axes.set(xlim=(-extent, extent), ylim=(-extent, extent), aspect="equal")


def show_normals(axes, d):
    """D over the hemisphere seen from above, relative to its peak."""
    grid = np.linspace(-1, 1, 301)
    x, y = np.meshgrid(grid, grid)
    inside = x * x + y * y < 0.998
    m = np.stack([x, y, np.sqrt(np.maximum(0.002, 1 - x * x - y * y))], axis=-1)
    density = np.where(inside, d.D(unit(m)), np.nan)
    level = np.log10(density / np.nanmax(density))
    axes.contourf(grid, grid, level, np.linspace(-3, 0, 13), cmap="viridis", extend="min")
    axes.add_patch(plt.Circle((0, 0), 1, fill=False, linewidth=0.6))
    axes.plot(*d.mean_normal[:2], "+", color="r", markersize=9)
    axes.plot(0, 0, "x", color="w", markersize=5, markeredgewidth=0.8)
    axes.set(aspect="equal", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05))
    axes.axis("off")


def show_sphere(axes, d, size=180):
    """A sphere of metal under one small light and a weak sky, U along the circles of latitude."""
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j] * 1.03
    inside = x * x + y * y < 1
    normal = np.stack([x, y, np.sqrt(np.maximum(1e-4, 1 - x * x - y * y))], axis=-1)
    tangent = unit(np.cross([0.0, 1.0, 0.0], normal))
    frame = np.stack([tangent, np.cross(normal, tangent), normal], axis=-2)
    view = unit(frame @ np.array([0.0, 0.0, 1.0]))
    light = unit(frame @ LIGHT)
    lit = light[..., 2] > 0
    upper = np.where(lit[..., None], light, [0.0, 0.0, 1.0])
    radiance = np.where(lit, ltmd.brdf(d, upper, view, model="separable") * upper[..., 2], 0)
    colour = (1.1 * radiance + 0.05 * normal[..., 2])[..., None] * np.array([1.0, 0.85, 0.62])
    axes.imshow(np.where(inside[..., None], (1 - np.exp(-colour)) ** (1 / 2.2), 1.0))
    half = unit(unit(LIGHT) + [0.0, 0.0, 1.0])
    axes.plot(*(size / 2 * (1 + half[:2] * [1, -1] / 1.03)), "x", color="w", markersize=5)
    axes.axis("off")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, default="ellipsoid.png")
    out = parser.parse_args().out
    u = np.random.default_rng(0).random((SAMPLES, 2))
    figure, axes = plt.subplots(3, len(ELLIPSOIDS), figsize=(8.4, 6.3), layout="constrained")
    for column, (name, d) in zip(axes.T, ELLIPSOIDS.items(), strict=True):
        column[0].set_title(name, fontsize=8)
        show_slopes(column[0], d, u)
        show_normals(column[1], d)
        show_sphere(column[2], d)
        column[0].tick_params(labelsize=6)
    labels = (
        "P22 over slopes, samples,\n+ mean slope",
        "D over normals,\n+ mean normal, × n",
        "sphere\n× mirror's highlight",
    )
    for row, text in zip(axes[:, 0], labels, strict=True):
        row.text(-0.45, 0.5, text, rotation=90, va="center", fontsize=8, transform=row.transAxes)
    figure.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
