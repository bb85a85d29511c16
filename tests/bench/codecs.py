# SPDX-License-Identifier: Apache-2.0
"""Time, size and error of each codec and precision for the frames of a sequence, as Markdown.

The picture is the tension of an animated shape with its margin: 4096 x 4096 RGBA by default, of a
mesh of 80,000 faces. Seconds of wall and of CPU time (which other load on the machine disturbs
less) are the best of the rounds, in which the settings take turns; sizes are the mean of the
frames; errors are the largest of any channel and frame, relative to the value
(absolute below 1).
"""

import argparse
import pathlib
import sys
import tempfile
import time

import ltmd
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "python"))
import meshes

COMPRESSIONS = ("none", "zips", "zip", "piz")
PRECISIONS = {
    "float": {},
    "float, 16 bits": {"mantissa_bits": 16},
    "float, 12 bits": {"mantissa_bits": 12},
    "float, 10 bits": {"mantissa_bits": 10},
    "half": {"half": True},
}


def pictures(size, frames):
    shape = meshes.sphere(400, 200)
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    coverage = ltmd.TexelCoverage(mesh, size, size, margin=16)
    for frame in frames:
        t = ltmd.tension(mesh, rest, meshes.twisted(shape, 0.3 * frame))
        pixels = np.ones((size, size, 4), np.float32)
        pixels[..., :3] = coverage.bake(t)
        yield pixels


def clocks():
    return np.array([time.perf_counter(), time.process_time()])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=int, default=4096)
    parser.add_argument("--frames", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    settings = [(c, p) for p in PRECISIONS for c in COMPRESSIONS]
    writing = {key: [] for key in settings}
    reading = {key: [] for key in settings}
    sizes = {key: [] for key in settings}
    errors = dict.fromkeys(settings, 0.0)
    raw = options.size**2 * 16
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "frame.exr"
        for number, pixels in enumerate(pictures(options.size, range(1, options.frames + 1))):
            for turn in range(options.rounds):
                for key in settings:
                    compression, precision = key
                    start = clocks()
                    ltmd.write_exr(path, pixels, compression=compression, **PRECISIONS[precision])
                    writing[key].append(clocks() - start)
                    start = clocks()
                    result = ltmd.read_exr(path)
                    reading[key].append(clocks() - start)
                    if turn == 0:
                        sizes[key].append(path.stat().st_size)
                        error = np.abs(result - pixels) / np.maximum(np.abs(pixels), 1)
                        errors[key] = max(errors[key], float(error.max()))
                print(f"frame {number + 1}, round {turn + 1}", file=sys.stderr, flush=True)
    print(
        f"{options.size} x {options.size} RGBA, {ltmd.threads()} threads, raw {raw / 1e6:.0f} MB\n"
    )
    print("| precision | compression | write: s | CPU s | read: s | CPU s | MB | error |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    for compression, precision in settings:
        key = compression, precision
        seconds = [*np.min(writing[key], axis=0), *np.min(reading[key], axis=0)]
        cells = [f"{value:.2f}" for value in seconds]
        cells.append(f"{np.mean(sizes[key]) / 1e6:.0f}")
        cells.append(f"{errors[key]:.1e}" if errors[key] else "0")
        print(f"| {precision} | {compression} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
