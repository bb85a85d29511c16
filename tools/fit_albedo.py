# SPDX-License-Identifier: Apache-2.0
"""Fit 1 / albedo of the anisotropic GGX and Beckmann closures by polynomials, and write the header
of the shaders: `python tools/fit_albedo.py` (the ltmd package, a minute).

The albedo is the library's single_scattering_albedo (F = 1, height-correlated masking) for alphas
up to 1 and all directions. It depends on the slopes along the view and across it, on how much both
belong together, and on the view's angle; the polynomial's variables are
  a  alpha along the view's azimuth,
  p  alpha across it,
  c  the square of the correlation of both slopes, in [0, 1],
  x  cos(theta) of the view where the surface is stretched to alpha = 1 along the view.
"""

import itertools
import pathlib
import textwrap

import ltmd
import numpy as np

DEGREE = 4
SAMPLES = 8000
ROOT = pathlib.Path(__file__).resolve().parents[1]
OUTPUT = ROOT / "osl/include/ltmd_albedo_fit.h"
KINDS = {"ggx": ltmd.GGX, "beckmann": ltmd.Beckmann}


def samples(kind, seed):
    """Variables [n, 4] and albedos of random lobes and views."""
    rng = np.random.default_rng(seed)
    alphas = np.exp(rng.uniform(np.log(0.01), 0, (SAMPLES, 2)))
    alphas[: SAMPLES // 4, 1] = 1  # at their bound lobes are cut to it
    alphas[: SAMPLES // 20] = alphas[: SAMPLES // 20, :1]
    cosine = rng.random(SAMPLES)
    cosine[::3] **= 2
    cosine = np.clip(cosine, 0.02, 1)
    azimuth = rng.uniform(0, np.pi / 2, SAMPLES)
    albedos = np.empty(SAMPLES)
    for i, ((ax, ay), z, phi) in enumerate(zip(alphas, cosine, azimuth, strict=True)):
        sine = np.sqrt(1 - z * z)
        view = np.array([sine * np.cos(phi), sine * np.sin(phi), z])
        albedos[i] = ltmd.single_scattering_albedo(KINDS[kind](ax, ay), view, points=48)
    ax2, ay2 = alphas.T**2
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    along2, across2 = ax2 * cos**2 + ay2 * sin**2, ax2 * sin**2 + ay2 * cos**2
    both2 = ((ay2 - ax2) * sin * cos) ** 2
    x = cosine / np.sqrt(cosine**2 + along2 * (1 - cosine**2))
    return np.stack(
        [np.sqrt(along2), np.sqrt(across2), both2 / (along2 * across2), x], axis=-1
    ), albedos


EXPONENTS = [e for e in itertools.product(range(DEGREE + 1), repeat=4) if sum(e) <= DEGREE]


def monomials(variables):
    return np.stack([np.prod(variables**e, axis=-1) for e in map(np.array, EXPONENTS)], axis=-1)


def fit(variables, albedos):
    """Coefficients whose worst relative error is small, by reweighted least squares."""
    matrix, weights = monomials(variables), albedos.copy()
    for _ in range(8):
        solution = np.linalg.lstsq(matrix * weights[:, None], weights / albedos, rcond=None)[0]
        error = np.abs(matrix @ solution * albedos - 1)
        weights *= 1 + 2 * (error / error.max()) ** 2
    return np.round(solution, 5)


def horner(coefficients, names, exponents=()):
    """The polynomial as an expression, nested by one variable after the other."""
    if len(exponents) == len(names):
        return repr(float(coefficients[exponents]))
    name = names[len(exponents)]
    terms = []
    for power in range(DEGREE + 1 - sum(exponents)):
        terms.append(horner(coefficients, names, (*exponents, power)))
    text = terms.pop()
    while terms:
        text = f"{terms.pop()} + {name} * ({text})"
    return text


def main():
    functions = []
    for kind in KINDS:
        coefficients = fit(*samples(kind, 0))
        variables, albedos = samples(kind, 1)
        error = np.abs(monomials(variables) @ coefficients * albedos - 1)
        print(f"{kind}: worst {error.max():.4f}, 99 % {np.quantile(error, 0.99):.4f}, "
              f"root mean square {np.sqrt(np.mean(error**2)):.4f}")  # fmt: skip
        body = horner(dict(zip(EXPONENTS, coefficients, strict=True)), "apcx")
        functions.append(
            f"// Relative error up to {error.max():.1%}, mostly below "
            f"{np.quantile(error, 0.9):.1%}.\n"
            f"float ltmd_{kind}_gain(float a, float p, float c, float x)\n{{\n"
            + textwrap.fill(
                f"return {body};", 100, initial_indent=" " * 4, subsequent_indent=" " * 8
            )
            + "\n}\n"
        )
    OUTPUT.write_text(
        "// SPDX-License-Identifier: Apache-2.0\n#pragma once\n\n"
        "// Written by tools/fit_albedo.py, where the variables are explained: 1 / albedo of a\n"
        "// closure, F = 1.\n// clang-format off\n\n" + "\n".join(functions)
    )


if __name__ == "__main__":
    main()
