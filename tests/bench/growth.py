# SPDX-License-Identifier: Apache-2.0
"""How times grow with the mesh and with the texture, as one picture.

    bash tests/bench/run.sh growth [--quick] [-o FILE.png]

Left: rest state, tension per corner and coverage (of 1024²) of a bent sheet, 10 thousand to 10
million triangles. Right: coverage, the gather of a frame and writing it, 256² to 8192², for a sheet
of 100 thousand triangles. Dotted lines grow in proportion. Each time is the best of
several runs.
"""

import argparse
import os
import pathlib
import tempfile
import time

import ltmd
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

PICTURE = pathlib.Path(__file__).resolve().parents[2] / "docs/pictures/growth.png"
STYLES = {
    "rest state": ("tab:blue", "o"),
    "tension per corner": ("tab:green", "s"),
    "coverage": ("tab:red", "^"),
    "bake of a frame": ("tab:green", "s"),
    "EXR, zip": ("tab:purple", "D"),
    "EXR, none": ("tab:blue", "o"),
}


def sheet(triangles):
    """A bent square of about so many triangles, its vertices shared: arrays for ltmd.Mesh."""
    side = max(1, round((triangles / 2) ** 0.5))
    line = np.arange(side + 1, dtype=np.int32)
    i, j = np.meshgrid(line, line, indexing="ij")
    uv = np.stack([j, i], axis=-1).reshape(-1, 2).astype(np.float32) / side
    x, y = uv.T
    rest = np.stack([x, y, 0 * x], axis=1)
    moved = np.stack([1.5 * x + 0.2 * y**2, 0.8 * y, 0.2 * np.sin(6 * x)], axis=1)
    first = (i[:-1, :-1] * (side + 1) + j[:-1, :-1]).reshape(-1, 1)
    faces = (first + [[0, 1, side + 2, 0, side + 2, side + 1]]).astype(np.int32).reshape(-1, 3)
    mesh = ltmd.Mesh(faces, np.arange(len(uv), dtype=np.int32), uv, len(uv))
    return mesh, rest.astype(np.float32), moved.astype(np.float32)


def best(call, *arguments, **options):
    """The best time and the result."""
    times = []
    # Several times: the first use of much memory is slow. Once where all are.
    while sum(times) < (10 if len(times) < 3 else 1) and len(times) < 50:
        result = None  # its memory serves the next
        start = time.perf_counter()
        result = call(*arguments, **options)
        times.append(time.perf_counter() - start)
    return min(times), result


def grow_mesh(counts):
    series = {"rest state": [], "tension per corner": [], "coverage": []}
    found = []
    for count in counts:
        mesh, positions, moved = sheet(count)
        found.append(len(mesh.triangles))
        seconds, rest = best(ltmd.RestState, mesh, positions)
        series["rest state"].append(seconds)
        series["tension per corner"].append(best(ltmd.tension, mesh, rest, moved)[0])
        series["coverage"].append(best(ltmd.TexelCoverage, mesh, 1024, 1024)[0])
        show(f"{found[-1]} triangles", series)
    return found, series


def grow_texture(sizes):
    mesh, positions, moved = sheet(100_000)
    t = ltmd.tension(mesh, positions, moved)
    series = {"coverage": [], "bake of a frame": [], "EXR, zip": [], "EXR, none": []}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.exr")
        for size in sizes:
            seconds, coverage = best(ltmd.TexelCoverage, mesh, size, size)
            series["coverage"].append(seconds)
            seconds, pixels = best(coverage.bake, t)
            series["bake of a frame"].append(seconds)
            for codec in ("zip", "none"):
                seconds, _ = best(ltmd.write_exr, path, pixels, compression=codec)
                series[f"EXR, {codec}"].append(seconds)
            show(f"{size} x {size}", series)
    return [size**2 for size in sizes], series


def show(what, series):
    print(what, *(f"{name} {times[-1] * 1e3:.1f} ms" for name, times in series.items()), sep=", ")


def draw(axes, amounts, series, what):
    for name, times in series.items():
        colour, marker = STYLES[name]
        axes.loglog(amounts, times, color=colour, marker=marker, label=name)
        # Through the last point, in proportion to the amount.
        axes.loglog(
            amounts,
            [times[-1] * a / amounts[-1] for a in amounts],
            color=colour,
            linestyle=":",
            linewidth=1,
        )
    axes.set_xlabel(what, loc="right", labelpad=0)
    axes.set_ylabel("seconds")
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=pathlib.Path, default=PICTURE)
    parser.add_argument("--quick", action="store_true", help="up to 300k triangles and 1024²")
    options = parser.parse_args()
    counts = [10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000]
    sizes = [256, 512, 1024, 2048, 4096, 8192]
    if options.quick:
        counts, sizes = counts[:4], sizes[:3]
    print(f"load of the machine before the run: {os.getloadavg()[0]:.1f}")
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 5), layout="constrained")
    draw(left, *grow_mesh(counts), "triangles")
    left.set_title("growth with the mesh, coverage at 1024²")
    draw(right, *grow_texture(sizes), "texels")
    right.set_title("growth with the texture, 100k triangles")
    figure.suptitle(f"ltmd {ltmd.__version__}, {ltmd.threads()} threads; dotted: proportional")
    options.output.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(options.output, dpi=100)
    print(options.output)


if __name__ == "__main__":
    main()
