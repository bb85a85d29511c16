# SPDX-License-Identifier: Apache-2.0
"""How far the lobes that Cycles renders are from exact GTR: lobe_error.py --out FILE.png"""

import argparse
import sys
from pathlib import Path

import ltmd
import matplotlib.pyplot as plt
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "osl"))
from directional_light import polar  # noqa: E402

ANGLES = np.array([1, *range(10, 86, 5), 87, 89])
KINDS = {"ggx": ltmd.GGX, "beckmann": ltmd.Beckmann}
AZIMUTH = 30


class Closures:
    """A sum of closures, each with its share of what the view sees and masking of its own."""

    def __init__(self, alpha, tail, m=None, bound=None, matched=False):
        m = np.eye(2) if m is None else np.asarray(m, float)
        mixture = ltmd.fit_lobes(alpha, tail, 3 if tail <= 2 else 5)
        self.weight, self.matched = mixture.weight, matched
        kinds = [KINDS[k] for k in mixture.kind]
        self.lobes = [k(a, a).transformed(m) for k, a in zip(kinds, mixture.alpha, strict=True)]
        self.closures = self.lobes
        if bound:
            axes = 1 / np.diag(m)  # of diagonal maps
            self.closures = [
                k(*np.minimum(a * axes, bound)) for k, a in zip(kinds, mixture.alpha, strict=True)
            ]

    def shares(self, v):
        shares = self.weight * [d.projected_area(v) for d in self.lobes]
        shares /= shares.sum()
        if self.matched:
            shares *= [albedo(d, v) for d in self.lobes]
            shares /= [albedo(d, v) for d in self.closures]
        return shares

    def albedo(self, v):
        return self.shares(v) @ [albedo(d, v) for d in self.closures]

    def brdf(self, v, o):
        return self.shares(v) @ [ltmd.brdf(d, v, o) for d in self.closures]


def albedo(d, v, points=64):
    return ltmd.single_scattering_albedo(d, v, points=points)


def exact_albedo(d, v):
    # The visible normals of a mixture jump between its parts: a finer grid.
    return albedo(d, v, 512)


def plot_albedo(axis):
    for alpha, tail, colour in (
        (0.1, 1.4, "C0"),
        (0.25, 1.4, "C1"),
        (0.25, 0.5, "C2"),
        (0.25, 3, "C3"),
    ):
        exact, lobes = ltmd.GTR(alpha, tail), Closures(alpha, tail)
        views = polar(ANGLES, AZIMUTH)
        ratio = [lobes.albedo(v) / exact_albedo(exact, v) - 1 for v in views]
        axis.plot(ANGLES, 100 * np.array(ratio), color=colour, label=f"alpha {alpha}, tail {tail}")
    axis.set(xlabel="angle of the view, degrees", ylabel="difference of albedo, %")
    axis.set_title("Reflected light: sum of lobes over exact GTR")
    axis.legend(fontsize=8)


def plot_pointwise(axis):
    out = np.arange(-89.5, 90, 0.5)
    for angle, colour in ((30, "C0"), (60, "C1"), (80, "C2"), (87, "C3")):
        v = polar(angle, 0)
        o = polar(out, 0)
        exact = ltmd.brdf(ltmd.GTR(0.16, 1.4), v, o)
        lobes = Closures(0.16, 1.4).brdf(v, o)
        axis.plot(out, 100 * (lobes / exact - 1), color=colour, label=f"seen at {angle}")
    axis.axhline(0, color="0.7", lw=0.8)
    axis.set(xlabel="angle of the light in the view's plane, degrees (mirror: below 0)")
    axis.set(ylabel="difference of the BRDF, %", ylim=(-30, 30))
    axis.set_title("Alpha 0.16, tail 1.4: each direction of light")
    axis.legend(fontsize=8)


def plot_squeezed(axis):
    m = np.diag([1, 0.4])
    views = polar(ANGLES, AZIMUTH)
    exact = ltmd.GTR(0.25, 1.4).transformed(m)
    for label, lobes, style in (
        ("lobes as they are", Closures(0.25, 1.4, m), "C0-"),
        ("closures, cut to alpha 1", Closures(0.25, 1.4, m, 1), "C3--"),
        ("closures with the lobes' energy", Closures(0.25, 1.4, m, 1, True), "C1:"),
    ):
        axis.plot(ANGLES, [lobes.albedo(v) for v in views], style, lw=2, label=label)
    axis.plot(ANGLES, [exact_albedo(exact, v) for v in views], "0.1", lw=1, label="exact GTR")
    axis.set(xlabel="angle of the view, degrees", ylabel="albedo", ylim=(0, 1))
    axis.set_title("Squeezed to 40 %: alpha 0.25, tail 1.4")
    axis.legend(fontsize=8)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", required=True)
    arguments = parser.parse_args()
    figure, axes = plt.subplots(1, 3, figsize=(15, 4.4), layout="constrained")
    plot_albedo(axes[0])
    plot_pointwise(axes[1])
    plot_squeezed(axes[2])
    figure.savefig(arguments.out, dpi=110)


if __name__ == "__main__":
    main()
