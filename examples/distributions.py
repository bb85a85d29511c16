# SPDX-License-Identifier: Apache-2.0
"""The isotropic distributions of the library, and GTR's tails.

    python examples/distributions.py --out distributions.png

Top: D and P22 on logarithmic scales, and as polar plots with their peak at 1; most about as
wide as GGX of roughness 0.3.
Bottom: Fig. 9 of microsurface-transformations, D and masking of GTR for roughness 0.6 and integer
tails, and its limits: no masking for alpha -> 0, D_0 and S_0 for alpha -> 1.
"""

import argparse
import pathlib

import ltmd
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ALPHA = 0.3
# Past 89.9 degrees the tails' slopes leave the picture.
ANGLES = np.radians(np.linspace(-89.9, 89.9, 1439))


def like_ggx(parameter):
    return ltmd.convert(ALPHA, "ggx_alpha", parameter, "half_angle")


def two_scales(r):
    """Fine scratches on a dull surface, for Tabulated."""
    return np.exp(-((r / 0.15) ** 2)) + 0.1 / (1 + (r / 0.8) ** 2) ** 2


DISTRIBUTIONS = {
    "GGX": ltmd.GGX(ALPHA),
    "Beckmann": ltmd.Beckmann(like_ggx("beckmann_alpha")),
    "GTR, tail 1": ltmd.GTR(0.19, 1.0),
    "GTR, tail 4": ltmd.GTR(0.45, 4.0),
    "STD, tail 3": ltmd.STD(0.31, 3.0),
    "Phong": ltmd.Phong(like_ggx("phong_exponent")),
    "Gauss": ltmd.Gauss(like_ggx("gauss_m")),
    "Schlick": ltmd.SchlickMDF(like_ggx("schlick_m")),
    "Sawicki": ltmd.SawickiDS(like_ggx("sawicki_n")),
    "Sheen": ltmd.Sheen(ALPHA),
    "Discrete GGX": ltmd.DiscreteGGX(ALPHA, 1000, 0.05, 0),
    "Tabulated": ltmd.Tabulated(two_scales),
}


def direction(theta):
    return np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=-1)


def slope(theta):
    return np.stack([-np.tan(theta), 0 * theta], axis=-1)


def all_distributions(d_log, d_polar, p22_log, p22_polar):
    colours = plt.get_cmap("tab20")([0, 2, 4, 5, 6, 8, 10, 12, 14, 16, 18, 1])
    slopes = np.geomspace(1e-2, 30, 400)
    positive = ANGLES[ANGLES >= 0]
    for (name, d), colour in zip(DISTRIBUTIONS.items(), colours, strict=True):
        style = {"color": colour, "lw": 1.2}
        density = d.D(direction(ANGLES))
        d_log.semilogy(np.degrees(positive), d.D(direction(positive)), label=name, **style)
        d_polar.plot(ANGLES, density / density.max(), **style)
        along = d.P22(np.stack([slopes, 0 * slopes], axis=-1))
        p22_log.loglog(slopes, along, **style)
        p22 = d.P22(slope(ANGLES))
        p22_polar.plot(ANGLES, p22 / p22.max(), **style)
    d_log.set_ylim(1e-3, 20)
    d_log.set_title("D against the angle from the normal")
    d_log.legend(fontsize=6, frameon=False, ncols=2)
    d_polar.set_title("D / max D, polar")
    p22_log.set_ylim(1e-6, 20)
    p22_log.set_title("P22 against the slope")
    p22_polar.set_title("P22 / max P22 against the slope's angle, polar")
    for axes in (d_polar, p22_polar):
        axes.set_theta_zero_location("N")
        axes.set_thetalim(-np.pi / 2, np.pi / 2)
        axes.set_rlim(0, 1)
        axes.set_rticks([0.5, 1])
        axes.set_thetagrids(range(-90, 91, 30))


def tails(d_axes, s_axes):
    """Fig. 9."""
    theta = np.radians(np.linspace(0, 89.99, 400))
    for gamma in range(5):
        d = ltmd.GTR(0.6, float(gamma))
        d_axes.plot(np.degrees(theta), d.D(direction(theta)), label=rf"$\gamma$ = {gamma}")
        s_axes.plot(np.degrees(theta), d.G1(direction(theta)))
    d_axes.set_title(r"$D_\gamma$, roughness 0.6")
    s_axes.set_title(r"masking $S_\gamma$, roughness 0.6")
    d_axes.legend(fontsize=7, frameon=False)


def limits(d_axes, s_axes):
    theta = np.radians(np.linspace(0, 89.99, 400))
    rough = ltmd.GTR(1.0, 0.0)
    for gamma, line in ((1.0, "-"), (4.0, "--")):
        for k, alpha in enumerate((0.01, 0.1, 0.3, 0.6, 0.9, 0.99)):
            d = ltmd.GTR(alpha, gamma)
            style = {"color": plt.get_cmap("viridis")(k / 6), "ls": line, "lw": 1.1}
            density = d.D(direction(theta)) / rough.D(direction(theta))
            d_axes.semilogy(np.degrees(theta), density, **style)
            label = rf"$\alpha$ = {alpha}" if gamma == 1 else None
            s_axes.plot(np.degrees(theta), d.G1(direction(theta)), label=label, **style)
    s_axes.plot(np.degrees(theta), rough.G1(direction(theta)), "k:", label=r"$S_0$")
    d_axes.axhline(1, color="k", ls=":")
    d_axes.set_ylim(1e-3, 1e4)
    d_axes.set_title(
        r"$D_\gamma/D_0$ for $\alpha\to 0$, $\alpha\to 1$; dashed: $\gamma$ = 4, else 1"
    )
    s_axes.set_title(r"$S_\gamma$ for $\alpha\to 0$, $\alpha\to 1$; dashed: $\gamma$ = 4, else 1")
    s_axes.legend(fontsize=7, frameon=False, loc="lower left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    plt.rcParams |= {"axes.titlesize": 9, "xtick.labelsize": 7, "ytick.labelsize": 7}
    figure = plt.figure(figsize=(13, 6.6), layout="constrained")
    top = [figure.add_subplot(2, 4, k, polar=k in (2, 4)) for k in range(1, 5)]
    bottom = [figure.add_subplot(2, 4, k) for k in range(5, 9)]
    all_distributions(*top)
    tails(*bottom[:2])
    limits(*bottom[2:])
    for axes in [*top, *bottom]:
        axes.grid(True, alpha=0.25)
    for axes in (top[0], *bottom):
        axes.set_xlabel("degrees from the normal", fontsize=7, labelpad=1)
    top[2].set_xlabel("slope", fontsize=7, labelpad=1)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(options.out, dpi=90)
    print(options.out)


if __name__ == "__main__":
    main()
