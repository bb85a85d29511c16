# SPDX-License-Identifier: Apache-2.0
"""The budgets of the geometry branch: ratios within one run on one machine, as a Markdown table.

Every time is the best of several runs. The streaming limit of a function is the time that reading
or writing each of its arrays once takes at the two-thread copy bandwidth: positions, the triangles'
vertices, R^-1, rest areas, one fan index per triangle corner, and the output. The numba version is
given the same prepared arrays as ours, in float32, with fastmath and two threads.
"""

import argparse
import functools
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import threading
import time

import ltmd
import numba
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "python"))
import meshes

THREADS = 2


def best(call, *arguments, seconds=1.0, least=3):
    times = []
    call(*arguments)
    while len(times) < least or sum(times) < seconds:
        start = time.perf_counter()
        call(*arguments)
        times.append(time.perf_counter() - start)
    return min(times)


def best_in_turns(*calls, rounds=40):
    """The best time of each call, taken in turns so that other load hits them alike."""
    times = [[] for _ in calls]
    for _ in range(rounds):
        for call, taken in zip(calls, times, strict=True):
            start = time.perf_counter()
            call()
            taken.append(time.perf_counter() - start)
    return [min(taken) for taken in times]


def copy_bandwidth(size=1 << 28):
    """Bytes read plus bytes written per second by two threads that copy."""
    source, target = np.ones(size, np.uint8), np.empty(size, np.uint8)
    half = size // 2

    def copy():
        parts = [slice(0, half), slice(half, size)]
        threads = [
            threading.Thread(target=np.copyto, args=(target[part], source[part])) for part in parts
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    return 2 * size / best(copy, seconds=2)


class Prepared:
    """What every implementation may prepare from the rest state, in NumPy."""

    def __init__(self, shape):
        t, v, uv = shape.topology
        self.vertices = np.ascontiguousarray(v[t])
        p = shape.positions.astype(np.float64)[self.vertices]
        e = np.stack([p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]], axis=2)
        w = uv.astype(np.float64)[t]
        a, b = w[:, 1] - w[:, 0], w[:, 2] - w[:, 0]
        uv_area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        x = (e[:, :, 0] * b[:, 1:] - e[:, :, 1] * a[:, 1:]) / uv_area[:, None]
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        z = np.cross(e[:, :, 0], e[:, :, 1])
        self.area = (np.linalg.norm(z, axis=1) / 2).astype(np.float32)
        z /= np.linalg.norm(z, axis=1, keepdims=True)
        r = np.einsum("aik,ikj->iaj", np.stack([x, np.cross(z, x)])[:, :, :], e)
        self.inverse = np.linalg.inv(r).astype(np.float32)
        # On a grid of one chart the fan of a corner is all faces around its vertex.
        self.corner_vert = v
        order = np.argsort(self.vertices.ravel(), kind="stable")
        self.fan_triangles = (order // 3).astype(np.int32)
        counts = np.bincount(self.vertices.ravel(), minlength=len(shape.positions))
        self.fan_start = np.append(0, np.cumsum(counts)).astype(np.int32)
        self.fan_area = np.add.reduceat(self.area[self.fan_triangles], self.fan_start[:-1])

    def tension_numpy(self, deformed, per):
        p = deformed[self.vertices]
        d1, d2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        i = self.inverse
        u = d1 * i[:, 0, 0, None] + d2 * i[:, 1, 0, None]
        v = d1 * i[:, 0, 1, None] + d2 * i[:, 1, 1, None]
        t11 = np.sqrt(np.sum(u * u, axis=1))
        t12 = np.sum(u * v, axis=1) / t11
        t22 = np.linalg.norm(np.cross(u, v), axis=1) / t11
        t = np.stack([t11, t12, t22], axis=1) * self.area[:, None]
        sums = np.add.reduceat(t[self.fan_triangles], self.fan_start[:-1])
        mean = sums / self.fan_area[:, None]
        return mean if per == "vertex" else mean[self.corner_vert]

    def tension_numba(self, deformed, per):
        t = np.empty((len(self.vertices), 3), np.float32)
        numba_triangles(deformed, self.vertices, self.inverse, self.area, t)
        mean = np.empty((len(self.fan_start) - 1, 3), np.float32)
        numba_means(t, self.fan_start, self.fan_triangles, self.fan_area, mean)
        if per == "vertex":
            return mean
        out = np.empty((len(self.corner_vert), 3), np.float32)
        numba_gather(mean, self.corner_vert, out)
        return out

    def streamed_bytes(self, deformed, per):
        arrays = [deformed, self.vertices, self.inverse, self.area, self.fan_triangles]
        outputs = len(self.corner_vert) if per == "corner" else len(deformed)
        return sum(a.nbytes for a in arrays) + 12 * outputs


@numba.njit(parallel=True, fastmath=True, cache=False)
def numba_triangles(p, vertices, inverse, area, out):
    for i in numba.prange(len(vertices)):
        a, b, c = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        x1, y1, z1 = p[b, 0] - p[a, 0], p[b, 1] - p[a, 1], p[b, 2] - p[a, 2]
        x2, y2, z2 = p[c, 0] - p[a, 0], p[c, 1] - p[a, 1], p[c, 2] - p[a, 2]
        i00, i01 = inverse[i, 0, 0], inverse[i, 0, 1]
        i10, i11 = inverse[i, 1, 0], inverse[i, 1, 1]
        ux, uy, uz = x1 * i00 + x2 * i10, y1 * i00 + y2 * i10, z1 * i00 + z2 * i10
        vx, vy, vz = x1 * i01 + x2 * i11, y1 * i01 + y2 * i11, z1 * i01 + z2 * i11
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        t11 = np.sqrt(ux * ux + uy * uy + uz * uz)
        w = area[i]
        out[i, 0] = w * t11
        out[i, 1] = w * (ux * vx + uy * vy + uz * vz) / t11
        out[i, 2] = w * np.sqrt(nx * nx + ny * ny + nz * nz) / t11


@numba.njit(parallel=True, fastmath=True, cache=False)
def numba_means(t, start, triangles, area, out):
    for i in numba.prange(len(start) - 1):
        x = y = z = np.float32(0)
        for k in range(start[i], start[i + 1]):
            x += t[triangles[k], 0]
            y += t[triangles[k], 1]
            z += t[triangles[k], 2]
        w = np.float32(1) / area[i]
        out[i, 0], out[i, 1], out[i, 2] = x * w, y * w, z * w


@numba.njit(parallel=True, fastmath=True, cache=False)
def numba_gather(values, index, out):
    for i in numba.prange(len(index)):
        for k in range(3):
            out[i, k] = values[index[i], k]


ROWS = []


def row(work, ratio, bar, at_most=True, note=""):
    held = None if bar is None else (ratio <= bar if at_most else ratio >= bar)
    sign = "≤" if at_most else "≥"
    ROWS.append(
        f"| {work} | {ratio:.2f} | {'' if bar is None else f'{sign} {bar:g}'} "
        f"| {'' if held is None else 'yes' if held else '**no**'} | {note} |"
    )
    print(ROWS[-1], flush=True)


def bench_tension(bandwidth):
    for vertices in (25_000, 100_000, 400_000):
        side = round(vertices**0.5) - 1
        shape = meshes.grid(side, side)
        prepared = Prepared(shape)
        mesh = shape.mesh()
        rest = shape.rest(mesh)
        deformed = meshes.twisted(shape)
        for per in ("corner", "vertex"):
            ours = ltmd.tension(mesh, rest, deformed, per=per)
            for other in (prepared.tension_numpy, prepared.tension_numba):
                assert np.allclose(ours, other(deformed, per), atol=1e-4), other
            t, t_numba = best_in_turns(
                functools.partial(ltmd.tension, mesh, rest, deformed, per),
                functools.partial(prepared.tension_numba, deformed, per),
            )
            limit = prepared.streamed_bytes(deformed, per) / bandwidth
            what = f"tension per {per}, {vertices // 1000}k vertices"
            bars = vertices >= 100_000
            row(f"{what}: × streaming limit", t / limit, 3 if bars else None, note=ms(t))
            row(f"{what}: numba / ours", t_numba / t, 2.5 if bars else None, False, ms(t_numba))
            t_numpy = best(prepared.tension_numpy, deformed, per)
            row(f"{what}: NumPy / ours", t_numpy / t, None, note=ms(t_numpy))


def ms(seconds):
    return f"{seconds * 1e3:.1f} ms"


def bench_bake(size, blender_python):
    shape = meshes.grid(158, 158)
    mesh = shape.mesh()
    values = ltmd.tension(mesh, shape.rest(mesh), meshes.twisted(shape), per="corner")
    t_coverage = best(ltmd.TexelCoverage, mesh, size, size, seconds=0, least=2)
    coverage = ltmd.TexelCoverage(mesh, size, size)
    pixels = coverage.bake(values)
    t = best(coverage.bake, values)
    t_copy = best(pixels.copy)
    row(f"bake of a prepared {size}²: × copy of the pixels", t / t_copy, 3, note=ms(t))
    target = pixels.copy()
    t_warm = best(np.copyto, target, pixels)
    row("the same: × copy into memory already in use", t / t_warm, None, note=ms(t_warm))
    if blender_python:
        out = subprocess.run(
            [blender_python, str(pathlib.Path(__file__).with_name("cycles_bake.py")), str(size)],
            capture_output=True,
            text=True,
        ).stdout
        t_cycles = float(out.rpartition("seconds:")[2])
        note = f"{ms(t_coverage)}, Cycles {ms(t_cycles)}"
        row("coverage: Cycles' emission bake / ours", t_cycles / t_coverage, 20, False, note)
    return np.dstack([pixels, np.ones((size, size), np.float32)])


def bench_exr(pixels):
    import OpenImageIO as oiio

    oiio.attribute("threads", THREADS)
    height, width, channels = pixels.shape
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.exr")

        def ours(codec):
            ltmd.write_exr(path, pixels, compression=codec)

        def theirs(codec):
            spec = oiio.ImageSpec(width, height, channels, oiio.FLOAT)
            spec.attribute("compression", codec)
            out = oiio.ImageOutput.create(path)
            assert out.open(path, spec) and out.write_image(pixels) and out.close()

        for codec in ("none", "zips", "zip"):
            seconds, ratios = [], []
            for write in (ours, theirs):
                seconds.append(best(write, codec, seconds=3))
                ratios.append(pixels.nbytes / os.path.getsize(path))
            note = f"{ms(seconds[0])}; packed {ratios[0]:.2f} : 1, theirs {ratios[1]:.2f} : 1"
            ratio = seconds[1] / seconds[0]
            row(f"EXR {codec}, {width}²: OpenImageIO / ours", ratio, 1, False, note)


def bench_sequence(frames, size):
    shape = meshes.grid(99, 99)
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    states = [meshes.twisted(shape, k / 40) for k in range(40)]

    def cpu():
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return usage.ru_utime + usage.ru_stime

    with tempfile.TemporaryDirectory() as folder:
        sequence = ltmd.SequenceBaker(mesh, rest, size, size)
        start, start_cpu = time.perf_counter(), cpu()
        for frame in range(frames):
            path = os.path.join(folder, f"grid_tension.{frame:04d}.exr")
            sequence.frame(states[frame % len(states)], {"tension": path})
        sequence.finish()
        wall, used = time.perf_counter() - start, cpu() - start_cpu
    ideal = used / min(THREADS, os.cpu_count())
    note = f"{wall:.1f} s, CPU {used:.1f} s"
    row(f"{frames} frames at {size}²: wall × cores / CPU time", wall / ideal, 1.15, note=note)


def bench_memory(size):
    code = f"""
import sys; sys.path.insert(0, {str(pathlib.Path(meshes.__file__).parent)!r})
import ltmd, meshes, tempfile
def status(key):
    return 1024 * int(next(s for s in open("/proc/self/status") if s.startswith(key)).split()[1])
shape = meshes.grid(158, 158)
mesh = shape.mesh(); rest = shape.rest(mesh); deformed = meshes.twisted(shape)
before = status("VmRSS")
with tempfile.TemporaryDirectory() as folder:
    s = ltmd.SequenceBaker(mesh, rest, {size}, {size}, in_flight=2)
    for k in range(4):
        s.frame(deformed, {{"tension": f"{{folder}}/f.{{k:04d}}.exr"}})
    s.finish()
arrays = sum(a.nbytes for a in (*shape.topology, shape.positions))
print((status("VmHWM") - before) / ((12 + 2 * 16) * {size}**2 + 3 * arrays))
"""
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    row(f"memory of a {size}² bake: × (coverage + 2 frames + 3 × mesh)", float(out.stdout), 1)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--size", type=int, default=4096, help="texels of a bake, each way")
    parser.add_argument("--frames", type=int, default=250, help="frames of the sequence")
    parser.add_argument("--blender-python", help="a Python with bpy, for Cycles' own bake")
    options = parser.parse_args()
    numba.set_num_threads(THREADS)
    ltmd.set_threads(THREADS)
    bandwidth = copy_bandwidth()
    print(f"two-thread copy bandwidth: {bandwidth / 1e9:.1f} GB/s read + written")
    print(f"load of the machine before the run: {os.getloadavg()[0]:.1f}\n")
    print("| work | ratio | bar | held | |\n|---|---|---|---|---|")
    bench_tension(bandwidth)
    pixels = bench_bake(options.size, options.blender_python)
    bench_exr(pixels)
    bench_memory(options.size)
    bench_sequence(options.frames, 1024)


if __name__ == "__main__":
    main()
