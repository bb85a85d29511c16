# SPDX-License-Identifier: Apache-2.0
"""Fit GTR by few GGX and Beckmann lobes over a grid of (alpha, gamma), and write the table that the
library and the shaders read: `python tools/fit_lobe_table.py` (NumPy and SciPy, some minutes).

For gamma <= 2 all lobes are GGX; beyond, one is GGX and the others are Beckmann. Each fit minimises
the 16-norm of P22's relative error where u P22 >= 1e-3 of its peak, u = tan^2, by bounded least
squares that start from a neighbour on the grid: so all nodes lie on one branch and the lobes may be
interpolated. What is tabulated is smooth up to the borders:
  place   log B / log alpha^2 in [0, 1] for gamma <= 2, log (B / alpha^2) beyond; B = lobe alpha^2;
  weight  the logarithm of the weight over the factor by which it vanishes at the borders, less that
          of the last lobe.
"""

import pathlib

import numpy as np
import scipy.optimize

ALPHA_STEPS = 16  # of alpha from 1 to 1e-4, see node_alpha
GAMMA_STEPS = 8  # gamma = 0 ... 2 and 2 ... 4 in quarters
MAX_LOBES = 6
ROOT = pathlib.Path(__file__).resolve().parents[1]
OUTPUTS = (ROOT / "cpp/src/lobe_table.h", ROOT / "osl/include/ltmd_lobe_table.h")


def node_alpha(half, k):
    """Even steps of L = -log alpha^2, beyond gamma = 2 of L / (L + 3): there lobes scale with alpha
    where it is small."""
    # At alpha = 1 any lobes of B = 1 fit: the limit is wanted.
    share = max(k, 0.1) / ALPHA_STEPS
    most = -2 * np.log(1e-4)
    if half == 0:
        return np.exp(-share * most / 2)
    share *= most / (most + 3)
    return np.exp(-3 * share / (1 - share) / 2)


def node_gamma(half, j):
    # At 0 and 2 all but one weight vanish: the limit again.
    return np.clip(2 * half + j / 4, 2 * half + 0.002, 4 if half else 1.998)


def p22(alpha, gamma, u):
    """microsurface-transformations, eq. 32."""
    a2 = alpha**2
    if gamma == 1:
        scale = (a2 - 1) / np.log(a2)
    else:
        scale = (gamma - 1) * (a2 - 1) / (1 - a2 ** (1 - gamma))
    return scale / np.pi * (1 + u) ** (gamma - 2) * (u + a2) ** -gamma


def core(alpha, gamma):
    """Squared slopes, P22 there, and u P22 over its peak."""
    x = np.linspace(2 * np.log(alpha) - 9, 16, 800)
    u = np.exp(x)
    p = p22(alpha, gamma, u)
    share = u * p / np.max(u * p)
    keep = share > 2e-4
    return u[keep], p[keep], share[keep]


def factors(alpha, gamma, lobes):
    """How weights vanish at the borders: lobe 0 is the widest GGX or, beyond 2, the only one."""
    if gamma > 2:
        return np.array([1.0] + [(gamma - 2) * (1 - alpha**2)] * (lobes - 1))
    c = np.full(lobes, gamma * (2 - gamma))
    c[0] = 2 - gamma if lobes > 1 else 1
    if lobes > 1:
        c[-1] = gamma
    return c


def lobe_values(gamma, log_b, u):
    """P22 of each lobe, and its derivative by log B."""
    b = np.exp(log_b)
    ratio = u[:, None] / b
    ggx = 1 / (np.pi * b * (1 + ratio) ** 2)
    values, slopes = ggx, ggx * (ratio - 1) / (1 + ratio)
    if gamma > 2:
        beckmann = np.exp(-ratio) / (np.pi * b)
        values = np.concatenate([ggx[:, :1], beckmann[:, 1:]], axis=1)
        slopes = np.concatenate([slopes[:, :1], (beckmann * (ratio - 1))[:, 1:]], axis=1)
    return values, slopes


def weights(alpha, gamma, logs):
    w = factors(alpha, gamma, len(logs)) * np.exp(logs - np.max(logs))
    return w / np.sum(w)


def log_b_of(alpha, gamma, place):
    log_a2 = 2 * np.log(alpha)
    return log_a2 * place if gamma <= 2 else log_a2 + place


def max_relative_error(alpha, gamma, place, logs):
    u, p, share = core(alpha, gamma)
    values, _ = lobe_values(gamma, log_b_of(alpha, gamma, place), u)
    error = np.abs(values @ weights(alpha, gamma, logs) / p - 1)
    return np.max(error[share >= 1e-3])


def fit(alpha, gamma, place, logs, powers=(1, 7)):
    n = len(place)
    u, p, share = core(alpha, gamma)
    border = share**6 / (share**6 + 8e-4**6)
    scale = -2 * np.log(alpha) if gamma <= 2 else 1.0
    low, high = (0.0, 1.0) if gamma <= 2 else (-6.0, 12.0)
    start = np.concatenate([np.clip(place, low, high), logs - logs[-1]])
    # Where the lobes do not matter they stay: a pull far below the errors of interest.
    pull = 3e-5 * np.concatenate([np.full(n, 10.0 if gamma <= 2 else 1.0), np.ones(n)])

    def residual(t, power, size):
        w = weights(alpha, gamma, t[n:])
        log_b = log_b_of(alpha, gamma, t[:n])
        values, slopes = lobe_values(gamma, log_b, u)
        total = values @ w
        error = border * (total / p - 1)
        by_place = slopes * w * (-scale if gamma <= 2 else 1)
        by_weight = w * (values - total[:, None])
        jacobian = np.concatenate([by_place, by_weight], axis=1) * (border / p)[:, None]
        grown = (np.abs(error) / size) ** power
        return (
            np.concatenate([error * grown, pull * (t - start)]),
            np.concatenate([(power + 1) * grown[:, None] * jacobian, np.diag(pull)]),
        )

    t = start
    bounds = (
        np.concatenate([np.full(n, low - 1e-9), np.full(n, -np.inf)]),
        np.concatenate([np.full(n, high + 1e-9), np.full(n, np.inf)]),
    )
    for power in powers:
        size = np.max(np.abs(residual(t, 0, 1)[0]))
        t = scipy.optimize.least_squares(
            lambda t, power=power, size=size: residual(t, power, size)[0],
            t,
            jac=lambda t, power=power, size=size: residual(t, power, size)[1],
            bounds=bounds,
            x_scale="jac",
            max_nfev=100,
            ftol=1e-9,
            xtol=1e-9,
            gtol=1e-15,
        ).x
    return t[:n], t[n:] - t[-1]


def fit_grid(half, lobes):
    """float[ALPHA_STEPS + 1, GAMMA_STEPS + 1, 2, lobes], from the middle outwards."""
    table = np.full((ALPHA_STEPS + 1, GAMMA_STEPS + 1, 2, lobes), np.nan)
    k0, j0 = (8 if half else 4), 4

    def node(k, j, start):
        place, logs = fit(node_alpha(half, k), node_gamma(half, j), *start)
        order = [0, *(1 + np.argsort(place[1:]))] if half else np.argsort(place)
        table[k, j] = place[order], logs[order] - logs[order[-1]]

    def next_in_gamma(k, j, step):
        """The start from the nodes before, extended at the borders, where lobes nearly vanish."""
        before = [table[k, j - step * i] for i in (1, 2, 3)]
        if j in (0, GAMMA_STEPS):
            return 3 * before[0] - 3 * before[1] + before[2]
        return before[0]

    if half == 0:
        # By symmetry of the tails the middle lobe of gamma = 1 is half way.
        place = (np.arange(lobes) + 0.5) / lobes
    else:
        place = np.concatenate([[-1.6], np.linspace(-0.9, 3.5, 6)[: lobes - 1]])
    node(k0, j0, (place, np.zeros(lobes)))
    for k in [k0, *range(k0 + 1, ALPHA_STEPS + 1), *range(k0 - 1, -1, -1)]:
        if k != k0:
            node(k, j0, table[k - 1 if k > k0 else k + 1, j0])
        for j in range(j0 + 1, GAMMA_STEPS + 1):
            node(k, j, next_in_gamma(k, j, 1))
        for j in range(j0 - 1, -1, -1):
            node(k, j, next_in_gamma(k, j, -1))
    # Exactly one lobe at the borders.
    if half == 0:
        table[:, 0, 0, 0] = 0
        table[:, -1, 0, -1] = 1
    else:
        table[0] = 4 * table[1] - 6 * table[2] + 4 * table[3] - table[4]
        table[:, 0, 0, 0] = 0
        table[0, :, 0, 0] = 0
    return table


def write(tables):
    lines = [
        "// SPDX-License-Identifier: Apache-2.0",
        "// Written by tools/fit_lobe_table.py, where the numbers are explained; for C++ and OSL.",
        "// clang-format off",
        "#ifndef LTMD_LOBE_TABLE_ALPHA_STEPS",
        f"#define LTMD_LOBE_TABLE_ALPHA_STEPS {ALPHA_STEPS}",
        f"#define LTMD_LOBE_TABLE_GAMMA_STEPS {GAMMA_STEPS}",
        "// [alpha from 1 to 1e-4][gamma = 0 ... 2 or 2 ... 4 in quarters][place, weight][lobe]",
    ]
    for (half, lobes), table in tables.items():
        name = f"LTMD_LOBE_TABLE_{'TO_4' if half else 'TO_2'}_{lobes}"
        numbers = [f"{value:.5f}".rstrip("0").rstrip(".") for value in table.ravel()]
        numbers = [number if "." in number else number + ".0" for number in numbers]
        lines += ["", f"#define {name} \\"]
        row = "   "
        for i, number in enumerate(numbers):
            item = f" {number}," if i + 1 < len(numbers) else f" {number}"
            if len(row) + len(item) > 97:
                lines.append(row + " \\")
                row = "   "
            row += item
        lines.append(row)
    lines += ["", "#endif"]
    for path in OUTPUTS:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    write({(half, n): fit_grid(half, n) for half in (0, 1) for n in range(1, MAX_LOBES + 1)})
