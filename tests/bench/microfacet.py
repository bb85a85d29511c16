# SPDX-License-Identifier: Apache-2.0
"""The distributions on arrays in single precision, against Mitsuba 3 and NumPy in the same run.

Prints nanoseconds per direction and the ratios to the bar, Mitsuba's LLVM variant. That takes the
memory for results from its own cache of freed arrays: ours write to arrays of earlier calls, out=;
the time with fresh arrays is printed too. Beckmann is masked by the rational fit there, by the
exact Lambda here.
"""

import argparse
import glob
import os
import time

import ltmd
import numpy as np


def best(function, repeats):
    function()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def views_and_random(count):
    rng = np.random.default_rng(0)
    z = rng.uniform(0.05, 1, count).astype(np.float32)
    phi = rng.uniform(0, 2 * np.pi, count).astype(np.float32)
    r = np.sqrt(1 - z * z)
    return (
        np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1),
        rng.random((count, 2), dtype=np.float32),
    )


def ours(kind, alphas, v, u, repeats, M=None, fresh=False):
    d = getattr(ltmd, kind)(*alphas)
    m = d.sample(u)
    if M is not None:
        d = d.transformed(M)
    number, direction = (None, None) if fresh else (np.empty_like(v[:, 0]), np.empty_like(v))
    work = {
        "D": lambda: d.D(m, out=number),
        "G1": lambda: d.G1(v, out=number),
        "sample": lambda: d.sample(u, out=direction),
        "visible": lambda: d.sample_visible(v, u, out=direction),
        "pdf_visible": lambda: d.pdf_visible(v, m, out=number),
    }
    return {name: best(call, repeats) / len(v) * 1e9 for name, call in work.items()}


def numpy_ggx(alphas, v, u, repeats):
    ax, ay = np.float32(alphas[0]), np.float32(alphas[1])
    m = ltmd.GGX(*alphas).sample(u)

    def D():
        x, y, z = m[:, 0] / ax, m[:, 1] / ay, m[:, 2]
        return 1 / (np.float32(np.pi) * ax * ay * (x * x + y * y + z * z) ** 2)

    def G1():
        q = ((ax * v[:, 0]) ** 2 + (ay * v[:, 1]) ** 2) / v[:, 2] ** 2
        return 2 / (1 + np.sqrt(1 + q))

    return {name: best(f, repeats) / len(v) * 1e9 for name, f in (("D", D), ("G1", G1))}


def mitsuba_llvm(kind, alphas, v, u, repeats):
    libraries = glob.glob("/usr/lib/*/libLLVM*.so*") + glob.glob("/usr/lib/llvm-*/lib/libLLVM*.so*")
    if libraries:
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", max(libraries, key=os.path.basename))
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    m = mi.Vector3f(ltmd.GGX(0.3).sample(u).T)
    view, random = mi.Vector3f(v.T), mi.Point2f(u.T)
    dr.eval(m, view, random)
    d = {
        visible: mi.MicrofacetDistribution(getattr(mi.MicrofacetType, kind), *alphas, visible)
        for visible in (False, True)
    }

    def run(call):
        def timed():
            result = call()
            dr.eval(result)
            dr.sync_thread()

        return timed

    work = {
        "D": lambda: d[True].eval(m),
        "G1": lambda: d[True].smith_g1(view, mi.Vector3f(0, 0, 1)),
        "sample": lambda: d[False].sample(view, random)[0],
        "visible": lambda: d[True].sample(view, random)[0],
        "pdf_visible": lambda: d[True].pdf(view, m),
    }
    return {name: best(run(call), repeats) / len(v) * 1e9 for name, call in work.items()}


def mitsuba_scalar(kind, alphas, v, u):
    """Through Python's loop: what a caller of the scalar variant gets."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    d = mi.MicrofacetDistribution(getattr(mi.MicrofacetType, kind), *alphas, True)
    some = [mi.Vector3f(*row) for row in v[:20000].tolist()]
    seconds = best(lambda: [d.eval(m) for m in some], 3)
    return {"D": seconds / len(some) * 1e9}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    alphas = (0.3, 0.2)
    v, u = views_and_random(options.count)
    names = ["D", "G1", "sample", "visible", "pdf_visible"]

    def line(title, times, bar=None):
        cells = [f"{times[n]:11.2f}" if n in times else " " * 11 for n in names]
        ratios = [f"{bar[n] / times[n]:6.1f}" for n in names] if bar else []
        print(f"{title:32}" + "".join(cells) + ("   times faster:" + "".join(ratios)) * bool(bar))

    print(f"{'ns per direction':32}" + "".join(f"{n:>11}" for n in names))
    for kind in ("GGX", "Beckmann"):
        bar = mitsuba_llvm(kind, alphas, v, u, options.repeats)
        plain = ours(kind, alphas, v, u, options.repeats)
        under_m = ours(kind, alphas, v, u, options.repeats, [[1.3, 0.4], [-0.2, 0.8]])
        line(f"{kind}, Mitsuba scalar", mitsuba_scalar(kind, alphas, v, u))
        line(f"{kind}, Mitsuba LLVM", bar)
        if kind == "GGX":
            line("GGX, NumPy", numpy_ggx(alphas, v, u, options.repeats))
        line(f"{kind}, ltmd", plain, bar)
        fresh = ours(kind, alphas, v, u, options.repeats, fresh=True)
        line(f"{kind}, ltmd, fresh results", fresh, bar)
        line(f"{kind}, ltmd under M", under_m, bar)
        worst = max(under_m[n] / plain[n] for n in names)
        print(f"{'':32}transformed at most {worst:.2f} times the untransformed")
    for gamma in (1.4, 3):
        line(f"GTR(0.16, {gamma}), ltmd", ours("GTR", (0.16, gamma), v, u, options.repeats))


if __name__ == "__main__":
    main()
