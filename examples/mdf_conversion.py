# SPDX-License-Identifier: Apache-2.0
"""How alike distributions look once their roughness is converted.

    python examples/mdf_conversion.py --out mdf_conversion.png

Fig. 1 to 5 of microfacet-distribution-conversion in kind: unit forms for m_B 0.4 and 0.0447 and
their differences from Beckmann's, spheres lit by a small light, the luminance across the highlight;
and its section 4.1: the largest difference against the Blinn-Phong exponent, for every method.
"""

import argparse
import pathlib

import ltmd
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

BECKMANN, PHONG = "beckmann_alpha", "phong_exponent"
MODELS = {
    BECKMANN: ("Beckmann", "black", "-"),
    PHONG: ("Blinn-Phong", "tab:blue", "-"),
    "gauss_m": ("Gauss", "tab:green", "--"),
    "ggx_alpha": ("Trowbridge-Reitz", "tab:red", "-"),
    "sawicki_n": ("Sawicki", "tab:orange", "-"),
    "schlick_m": ("Schlick", "tab:purple", "-"),
}
# The Blinn-Phong exponents of Fig. 1 and 4, 2 and 5.
EXPONENTS = (10, 1000)
METHODS = {"closed_form": "-", "rmse": ":", "half_angle": "--"}


def values(n, method="closed_form"):
    return {name: ltmd.convert(n, PHONG, name, method) for name in MODELS}


def differences(n, method):
    """Per model: angles, and its unit form less Beckmann's in per cent."""
    converted = values(n, method)
    beta = np.linspace(0, min(1.57, 5 * converted[BECKMANN]), 2000)
    beckmann = ltmd.unit_mdf(BECKMANN, converted[BECKMANN], beta)
    forms = {name: ltmd.unit_mdf(name, converted[name], beta) for name in MODELS}
    return beta, forms, {name: 100 * (form - beckmann) for name, form in forms.items()}


def unit_forms(axes, below, n):
    beta, forms, off = differences(n, "closed_form")
    for name, (label, colour, line) in MODELS.items():
        axes.plot(np.degrees(beta), forms[name], line, color=colour, label=label, lw=1.2)
        if name != BECKMANN:
            below.plot(np.degrees(beta), off[name], line, color=colour, lw=1.2)
    axes.set_title(f"unit forms, N = {n}, $m_B$ = {values(n)[BECKMANN]:.4f}", fontsize=9)
    below.set_title("difference from Beckmann, % of its peak", fontsize=9)
    for each in (axes, below):
        each.set_xlabel("angle from the normal, degrees", fontsize=8, labelpad=1)


def sphere(name, value, size):
    """The specular luminance of a sphere under Ashikhmin and Shirley's model with another D."""
    light = np.array([0.35, 0.35, 0.87])
    light /= np.linalg.norm(light)
    view = np.array([0.0, 0.0, 1.0])
    halfway = (light + view) / np.linalg.norm(light + view)
    x, y = np.meshgrid(np.linspace(-1.04, 1.04, size), np.linspace(1.04, -1.04, size))
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.where(inside, 1 - x**2 - y**2, 0))
    normal = np.stack([x, y, z], axis=-1)
    beta = np.arccos(np.clip(normal @ halfway, -1, 1))
    to_light, to_view = normal @ light, normal @ view
    facing = inside & (to_light > 0)
    shape = ltmd.unit_mdf(name, value, beta) * to_light
    luminance = shape / (halfway @ light * np.maximum(np.maximum(to_light, to_view), 1e-6))
    return np.where(inside, np.where(facing, luminance, 0), np.nan)


def across(name, value, count=801):
    """Luminance along the line through the centre of the sphere and the highlight."""
    picture = sphere(name, value, count)
    diagonal = np.arange(count)
    return np.linspace(-1.04, 1.04, count) * np.sqrt(2), picture[count - 1 - diagonal, diagonal]


def spheres(row, section, n):
    converted = values(n)
    colours = plt.get_cmap("gray").copy()
    colours.set_bad("white")
    for axes, (name, (label, colour, line)) in zip(row, MODELS.items(), strict=True):
        picture = np.clip(sphere(name, converted[name], 220), 0, 1) ** (1 / 2.2)
        axes.imshow(
            0.06 + 0.94 * picture, cmap=colours, vmin=0, vmax=1, interpolation="antialiased"
        )
        axes.set_title(f"{label}\n{converted[name]:.4g}", fontsize=8, color=colour)
        axes.axis("off")
        place, luminance = across(name, converted[name])
        section.plot(place, luminance, line, color=colour, lw=1.2)
    width = 6 * values(n)[BECKMANN]
    section.set_xlim(max(0.28 - width, -1), min(0.28 + width, 1))
    section.set_title(f"luminance across the highlight, N = {n}", fontsize=9)


def largest_differences(axes):
    exponents = np.geomspace(7.5, 1e4, 40)
    for name, (_, colour, _) in MODELS.items():
        if name == BECKMANN:
            continue
        for method, line in METHODS.items():
            worst = [np.abs(differences(n, method)[2][name]).max() for n in exponents]
            axes.loglog(exponents, worst, line, color=colour, lw=1.2)
    printed = {PHONG: {10: 3.5, 40: 1, 100: 0.4, 1000: 0.03}}
    printed |= {"sawicki_n": {10: 7, 1000: 3}, "schlick_m": {10: 13, 1000: 15}}
    for name, points in printed.items():
        axes.plot(*zip(*points.items(), strict=True), "o", color=MODELS[name][1], ms=4)
    axes.set_title("largest difference from Beckmann, % of its peak", fontsize=9)
    axes.set_xlabel("Blinn-Phong exponent N", fontsize=8, labelpad=1)
    handles = [plt.Line2D([], [], color="black", ls=line) for line in METHODS.values()]
    handles.append(plt.Line2D([], [], color="black", marker="o", ls="", ms=4))
    axes.legend(handles, [*METHODS, "printed"], fontsize=7, frameon=False)


def relations(axes):
    """What half of the conversions' users ask: which alpha is an exponent."""
    n = np.geomspace(1, 1e4, 200)
    rmse = ltmd.convert(n, PHONG, "ggx_alpha")
    axes.loglog(n, rmse, ":", color="tab:red", lw=1.6, label="GGX, rmse")
    axes.loglog(n, ltmd.convert(n, PHONG, "ggx_alpha", "half_angle"), "--", color="tab:red", lw=1.2)
    shown = n[n > 7.5]
    closed = ltmd.convert(shown, PHONG, "ggx_alpha", "closed_form")
    axes.loglog(shown, closed, "-", color="tab:red", lw=0.8)
    axes.loglog(n, ltmd.convert(n, PHONG, BECKMANN), ":", color="black", lw=1.6)
    ward = n[n > 2]
    axes.loglog(ward, ltmd.convert(ward, PHONG, BECKMANN, "ward"), "-.", color="black", lw=0.8)
    axes.text(1.2, 0.42, r"GGX $\alpha$", color="tab:red", fontsize=8)
    axes.text(2.4, 0.13, "Beckmann $m_B$\n(dash-dotted: Ward)", fontsize=8)
    axes.set_title("roughness for a Blinn-Phong exponent", fontsize=9)
    axes.set_xlabel("Blinn-Phong exponent N", fontsize=8, labelpad=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    figure = plt.figure(figsize=(12, 9), layout="constrained")
    plots, pictures = figure.subfigures(2, 1, height_ratios=(1.3, 1))
    grid = plots.subplots(2, 3)
    for column, n in enumerate(EXPONENTS):
        unit_forms(grid[0, column], grid[1, column], n)
    grid[0, 0].legend(fontsize=7, frameon=False)
    largest_differences(grid[1, 2])
    relations(grid[0, 2])
    rows = pictures.subplots(2, 7, width_ratios=[1] * 6 + [2])
    for row, n in zip(rows, EXPONENTS, strict=True):
        spheres(row[:6], row[6], n)
    for axes in [*grid.ravel(), *rows[:, 6]]:
        axes.grid(True, alpha=0.25)
        axes.tick_params(labelsize=7)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(options.out, dpi=90)
    print(options.out)


if __name__ == "__main__":
    main()
