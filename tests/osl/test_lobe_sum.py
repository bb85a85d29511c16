# SPDX-License-Identifier: Apache-2.0
"""LTMD Glossy, where every alpha is at most 1, against a float64 model of the same lobes that is
integrated over the light: the sum of the lobes, one of them at random, and random normals."""

import ltmd
import numpy as np
from directional_light import polar, radiance, to_world
from tile_picture import WHITE, check, tile_means

ANGLES = (1, 30, 55, 72, 84)
CASES = [  # alpha, tail, lobes
    (0.3, 2, 1), (0.35, 1.4, 3), (0.4, 0.5, 5), (0.25, 3, 5), (0.25, 4, 6),
]  # fmt: skip
MAPS = ((0.3, 0.7, 0.4, (1.8, 0, 1.6)), (0, 0.3, 0, (1.6, 0.4, 1.4)))


def matrix(stretch, rotation, shear, t):
    return np.array([[t[0], t[1]], [0, t[2]]]) @ ltmd.material_matrix(stretch, rotation, shear)


def beckmann_lambda(d, directions, m):
    """The rational fit of the renderer (masking-shadowing, eq. 69), under the map m."""
    stretched = directions[..., :2] @ np.linalg.inv(m).T
    a = directions[..., 2] / np.maximum(d * np.hypot(*np.moveaxis(stretched, -1, 0)), 1e-12)
    return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0)


class Lobe:
    """A GGX or Beckmann lobe under a map as the renderer's closure has it."""

    def __init__(self, kind, alpha, m):
        self.kind, self.alpha, self.m = kind, alpha, m
        self.d = (ltmd.GGX if kind == "ggx" else ltmd.Beckmann)(alpha, alpha).transformed(m)
        assert alpha / np.linalg.svd(m)[1].min() <= 1

    def Lambda(self, v):
        if self.kind == "ggx":
            return self.d.Lambda(v)
        return beckmann_lambda(self.alpha, v, self.m)

    def light(self, v, points=200):
        """The light that it reflects to v, over a grid of its visible normals."""
        u = (np.arange(points) + 0.5) / points
        m = self.d.sample_visible(v, np.stack(np.meshgrid(u, u), axis=-1).reshape(-1, 2))
        o = 2 * (m @ v)[:, None] * m - v
        o = o[o[:, 2] > 0]
        # The sampler's density has the exact Lambda.
        g2 = (1 + self.d.Lambda(v)) / (1 + self.Lambda(v) + self.Lambda(o))
        return g2 @ radiance(o @ to_world(v).T) / points**2


def reflected(alpha, tail, count, m, view):
    """The light that the sum of lobes sends to the view."""
    mixture = ltmd.fit_lobes(alpha, tail, count)
    lobes = [Lobe(k, a, m) for k, a in zip(mixture.kind, mixture.alpha, strict=True)]
    shares = mixture.weight * [1 + lobe.Lambda(view) for lobe in lobes]
    return shares / shares.sum() @ [lobe.light(view) for lobe in lobes]


def test_sum_roulette_and_random_normals():
    places = [(case, angle) for case in CASES for angle in ANGLES]
    maps = [MAPS[i % 2] for i in range(len(places))]
    views = polar(
        [angle for _, angle in places], np.random.default_rng(0).uniform(0, 360, len(places))
    )
    expected = np.array(
        [
            reflected(*case, matrix(*m), view)
            for (case, _), m, view in zip(places, maps, views, strict=True)
        ]
    )
    # Sum and roulette; random normals are of the exact distribution, that of a single lobe.
    chosen = np.r_[np.tile(np.arange(len(places)), 2), : len(ANGLES)]
    modes = np.repeat([0, 1, 2], [len(places), len(places), len(ANGLES)])
    rows = [(*places[i][0], mode, places[i][1]) for i, mode in zip(chosen, modes, strict=True)]
    maps, views, expected = [maps[i] for i in chosen], views[chosen], expected[chosen]
    columns = np.array(rows, float).T
    mean, error = tile_means(
        "glossy",
        views,
        96,
        {
            "Roughness": columns[0],
            "Tail": columns[1],
            "Lobes": columns[2] + 0.5,
            "Mode": columns[3] + 0.5,
            "Stretch": [m[0] for m in maps],
            "Rotation": [m[1] for m in maps],
            "Shear": [m[2] for m in maps],
            "Tension": [m[3] for m in maps],
        },
        Color=WHITE,
    )
    # The table of lobes in the shader is interpolated in single precision.
    check(mean, error, expected, rows, 5e-4)


def test_lobes_are_near_exact_gtr():
    """The bounds that docs/reference_mode.md states; plotted by examples/lobe_error.py."""
    for alpha, tail, count in ((0.1, 1.4, 3), (0.25, 1.4, 3), (0.25, 0.5, 3), (0.16, 3, 5)):
        exact, mixture = ltmd.GTR(alpha, tail), ltmd.fit_lobes(alpha, tail, count)
        lobes = [Lobe(k, a, np.eye(2)) for k, a in zip(mixture.kind, mixture.alpha, strict=True)]
        for view in polar((1, 40, 70, 80, 85), 0):
            shares = mixture.weight * [1 + lobe.Lambda(view) for lobe in lobes]
            got = shares / shares.sum() @ [lobe.light(view, 100)[0] for lobe in lobes]
            want = ltmd.single_scattering_albedo(exact, view, points=256)
            assert abs(got / want - 1) < 0.03, (alpha, tail, view, got, want)
