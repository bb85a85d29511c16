# SPDX-License-Identifier: Apache-2.0
"""Masking models beside rays cast on a random surface: masking.py --out FILE.png"""

import argparse
import sys
from pathlib import Path

import ltmd
import matplotlib.pyplot as plt
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "python"))
from heightfield import Heightfield, gaussian_heights  # noqa: E402
from microfacet import direction, facing_area  # noqa: E402

ALPHA = 0.8
M = np.array([[1.6, 0.9], [0.0, 0.7]])
AZIMUTH = 0.6
SURFACES = 6
RAYS = 20_000
UP = np.array([0.0, 0.0, 1.0])
POINTS = {"fmt": "o", "ms": 4, "color": "0.1", "lw": 1, "zorder": 5}


class Visible:
    """The microfacets that v sees, as a distribution of normals."""

    def __init__(self, d, v, model):
        self.d, self.v, self.model = d, v, model

    def D(self, m):
        return self.d.D(m) * ltmd.G1(self.d, self.v, m, self.model)


def visible_part(d, v, model):
    """The part of the area facing v that a model calls visible."""
    return facing_area(Visible(d, v, model), v, ALPHA, azimuths=192) / d.projected_area(v)


def measure(fields, function):
    """The mean over the surfaces, and its standard error."""
    values = [function(field, np.random.default_rng(i)) for i, field in enumerate(fields)]
    return np.mean(values, axis=0), np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def seen_by_area(field, rng, v):
    points, index = field.points(rng, RAYS)
    m = field.normals(index)
    area = np.maximum(0, m @ v) / m[:, 2]
    return np.sum(area * field.visible(points, index, v)) / np.sum(area)


def seen_by_both(field, rng, a, b):
    points, index = field.points(rng, RAYS)
    m = field.normals(index)
    both = field.visible(points, index, a) & field.visible(points, index, b)
    return np.sum(both) / np.sum((m @ a > 0) & (m @ b > 0))


def errorbars(axis, x, measured, **options):
    mean, error = np.array(measured).T
    axis.errorbar(x, mean, 2 * error, **POINTS, **options)


def plot_models(axis, fields):
    d = ltmd.Beckmann(ALPHA)
    degrees = np.linspace(0, 89, 60)
    styles = {
        "separable": ("Smith, V-cavity (mean)", "C0", "-"),
        "implicit": ("implicit", "C3", "--"),
        "schlick_smith": ("Schlick-Smith", "C1", "--"),
        "kelemen": ("Kelemen", "C2", "--"),
    }
    for model, (label, colour, line) in styles.items():
        values = [visible_part(d, direction(t, AZIMUTH), model) for t in np.radians(degrees)]
        axis.plot(degrees, values, line, color=colour, label=label)
    at = np.arange(15, 90, 10)
    measured = [
        measure(fields, lambda f, r, t=t: seen_by_area(f, r, direction(t, AZIMUTH)))
        for t in np.radians(at)
    ]
    errorbars(axis, at, measured, label="rays")
    axis.set(xlabel="angle of the view, degrees", ylabel="visible part of the facing area")
    axis.set_title("Masking: table 3 in one picture")
    axis.legend(fontsize=8)


def plot_transformed(axis, fields, moved):
    d = ltmd.Beckmann(ALPHA)
    degrees = np.linspace(0, 360, 181)
    v = np.stack([direction(np.radians(80), p) for p in np.radians(degrees)])
    for name, one, surfaces, colour in (
        ("identity", d, fields, "C0"),
        ("under M", d.transformed(M), moved, "C4"),
    ):
        axis.plot(degrees, one.G1(v), color=colour, label=f"Smith, {name}")
        at = np.arange(15, 360, 30)
        measured = [
            measure(surfaces, lambda f, r, p=p: seen_by_area(f, r, direction(np.radians(80), p)))
            for p in np.radians(at)
        ]
        errorbars(axis, at, measured, label="rays" if surfaces is fields else None)
    axis.set(xlabel="azimuth of the view, degrees", ylabel="visible part of the facing area")
    axis.set(xlim=(0, 360), ylim=(0, 0.9))
    axis.set_title("At 80 degrees, as it is and under M = (1.6 0.9; 0 0.7)")
    axis.legend(fontsize=8, ncols=3, loc="lower center")


def plot_visible_normals(axis, fields, moved):
    rng = np.random.default_rng(0)
    v = direction(np.radians(85), AZIMUTH)
    along = v[:2] / np.hypot(*v[:2])
    edges = np.linspace(-2.4, 0.4, 57)
    middle = (edges[1:] + edges[:-1]) / 2

    def histogram(m):
        slopes = -(m[:, :2] / m[:, 2:]) @ along
        return np.histogram(slopes, edges)[0] / len(m) / np.diff(edges)

    u = rng.random((1_000_000, 3))
    for name, d, surfaces, colour in (
        ("identity", ltmd.Beckmann(ALPHA), fields, "C0"),
        ("under M", ltmd.Beckmann(ALPHA).transformed(M), moved, "C4"),
    ):
        rays = np.concatenate([f.visible_normals(rng, v, RAYS) for f in surfaces])
        axis.stairs(
            histogram(rays), edges, color=colour, fill=True, alpha=0.25, label=f"rays, {name}"
        )
        smith = histogram(d.sample_visible(v, u[:, :2]))
        axis.plot(middle, smith, color=colour, label=f"Smith, {name}")
        grooves = histogram(ltmd.v_cavity_sample_visible(d, v, u))
        axis.plot(middle, grooves, ":", color=colour, label=f"V-cavity, {name}")
    axis.set(xlabel="slope along the view (towards the viewer to the left)", ylabel="density")
    axis.set_title("Normals visible at 85 degrees")
    axis.legend(fontsize=8)


def plot_joint(axis, fields):
    d = ltmd.Beckmann(ALPHA)
    theta = np.radians(80)
    degrees = np.linspace(0, 180, 181)
    wi = direction(theta, AZIMUTH)
    wo = np.stack([direction(theta, AZIMUTH + p) for p in np.radians(degrees)])
    for model in ltmd.MASKING_MODELS[:4]:
        label = model.replace("_", "-") + f" (eq. {98 + ltmd.MASKING_MODELS.index(model)})"
        axis.plot(degrees, ltmd.G2(d, wi, wo, UP, model), label=label)
    at = np.array([0, 5, 10, 20, 40, 70, 110, 150, 180])
    measured = [
        measure(fields, lambda f, r, p=p: seen_by_both(f, r, wi, direction(theta, AZIMUTH + p)))
        for p in np.radians(at)
    ]
    errorbars(axis, at, measured, label="rays")
    axis.set(xlabel="azimuth between light and view, degrees", ylabel="part that both see")
    axis.set(ylim=(0, None))
    axis.set_title("Masking and shadowing, both at 80 degrees")
    axis.legend(fontsize=8)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    out = parser.parse_args().out
    heights = [
        gaussian_heights(np.random.default_rng(100 + i), 512, 16, ALPHA) for i in range(SURFACES)
    ]
    fields, moved = [Heightfield(h) for h in heights], [Heightfield(h, M) for h in heights]
    figure, axes = plt.subplots(2, 2, figsize=(11, 8), layout="constrained")
    plot_models(axes[0, 0], fields)
    plot_transformed(axes[0, 1], fields, moved)
    plot_visible_normals(axes[1, 0], fields, moved)
    plot_joint(axes[1, 1], fields)
    figure.suptitle(
        "Beckmann, alpha = 0.8, against rays cast on Gaussian surfaces "
        "(correlation length 16 facets; bars: 2 standard errors)"
    )
    figure.savefig(out, dpi=100, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()
