# SPDX-License-Identifier: Apache-2.0
"""A sphere under a small light, for a grid of maps M of its microsurface.

    python examples/sphere_grid.py --out sphere_grid.png

Each column is a stretch of the microsurface (microsurface-transformations, eq. 31), each row turns
or shears it: the highlight narrows along the stretch and turns with it.
"""

import argparse
import pathlib

import ltmd
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

STRETCHES = (-0.4, 0.0, 0.3, 0.5, 0.7)
ROWS = (("along U", 0.0, 0.0), ("turned by 45°", np.pi / 4, 0.0), ("sheared by 1", 0.0, 1.0))


def sphere(size):
    """Frames (X, Y, Z) of a sphere seen along -z, and where it is."""
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j] * 1.04
    inside = x * x + y * y < 1
    normal = np.stack([x, y, np.sqrt(np.maximum(0, 1 - x * x - y * y))], axis=-1)
    # U runs along the circles of latitude.
    tangent = np.stack([normal[..., 2], np.zeros_like(x), -normal[..., 0]], axis=-1)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-6)
    return tangent, np.cross(normal, tangent), normal, inside


def lights():
    """Directions over a small disc of light, and a weak second one, with their strength."""
    result = []
    for centre, radius, strength in (((0.35, 0.55, 0.8), 0.06, 1.0), ((-0.8, 0.1, 0.3), 0.1, 0.25)):
        centre = np.array(centre) / np.linalg.norm(centre)
        x = np.cross(centre, [0, 0, 1])
        x /= np.linalg.norm(x)
        y = np.cross(centre, x)
        for i in range(24):
            r, phi = radius * np.sqrt((i + 0.5) / 24), i * np.pi * (3 - np.sqrt(5))
            d = centre + r * (np.cos(phi) * x + np.sin(phi) * y)
            result.append((d / np.linalg.norm(d), strength / 24))
    return result


def render(distribution, size):
    tangent, bitangent, normal, inside = sphere(size)
    frame = np.stack([tangent, bitangent, normal], axis=-2)
    view = frame @ np.array([0.0, 0.0, 1.0])
    view[..., 2] = np.maximum(view[..., 2], 1e-4)
    picture = np.zeros((size, size))
    for direction, strength in lights():
        light = np.ascontiguousarray(frame @ direction)
        lit = light[..., 2] > 1e-4
        light[..., 2] = np.maximum(light[..., 2], 1e-4)
        light /= np.linalg.norm(light, axis=-1, keepdims=True)
        picture += strength * np.where(lit, ltmd.brdf(distribution, light, view) * light[..., 2], 0)
    picture += 0.02 * normal[..., 2]
    return np.where(inside, picture, np.nan)


def display(radiance):
    """Copper, by a filmic curve."""
    colour = radiance[..., None] * np.array([1.0, 0.62, 0.4]) * 1.1
    mapped = (1 - np.exp(-colour)) ** (1 / 2.2)
    return np.where(np.isnan(mapped), 1.0, mapped)


def smaller(picture):
    """Half the size, 2 x 2 pixels averaged."""
    h, w, c = picture.shape
    return picture.reshape(h // 2, 2, w // 2, 2, c).mean(axis=(1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("sphere_grid.png"))
    parser.add_argument("--size", type=int, default=180, help="pixels of one sphere")
    arguments = parser.parse_args()
    base = ltmd.GTR(0.2, 1.4)
    figure, axes = plt.subplots(
        len(ROWS), len(STRETCHES), figsize=(1.9 * len(STRETCHES), 2.0 * len(ROWS)), dpi=110
    )
    for i, (name, rotation, shear) in enumerate(ROWS):
        row = axes[i]
        for axis, stretch in zip(row, STRETCHES, strict=True):
            M = ltmd.material_matrix(stretch, rotation, shear)
            axis.imshow(smaller(display(render(base.transformed(M), 2 * arguments.size))))
            axis.set_xticks([])
            axis.set_yticks([])
            axis.spines[:].set_visible(False)
            if i == 0:
                axis.set_title(f"s = {stretch:g}")
        row[0].set_ylabel(name)
    figure.tight_layout(pad=0.4)
    figure.savefig(arguments.out)
    plt.close(figure)


if __name__ == "__main__":
    main()
