# SPDX-License-Identifier: Apache-2.0
"""Lobe mixtures: sums of their lobes, GTR as exact and as few lobes, and the table of the fits."""

import importlib.util
import pathlib

import ltmd
import numpy as np
import pytest
from microfacet import direction

ROOT = pathlib.Path(__file__).resolve().parents[2]
VIEWS = np.array([direction(t) for t in (0.0, 0.3, 1.0, 1.4, 1.55)])
SLOPES = np.outer(np.geomspace(1e-5, 1e3, 60), [0.6, 0.8])


def table_script():
    spec = importlib.util.spec_from_file_location("table", ROOT / "tools/fit_lobe_table.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def p22_error(mixture, exact, alpha):
    """The worst relative error where u P22 is at least 1e-3 of its peak."""
    u = np.exp(np.linspace(2 * np.log(alpha) - 9, 16, 3000))
    slopes = np.stack([np.sqrt(u), np.zeros_like(u)], axis=1)
    p = exact.P22(slopes)
    core = u * p >= 1e-3 * np.max(u * p)
    return np.max(abs(mixture.P22(slopes)[core] / p[core] - 1))


def test_a_mixture_adds_up(rng):
    mixture = ltmd.LobeMixture(["beckmann", "ggx", "ggx"], [0.1, 0.5, 0.03], [2, 5, 1])
    assert mixture.kind == ["ggx", "ggx", "beckmann"]
    np.testing.assert_array_equal(mixture.alpha, [0.5, 0.03, 0.1])
    np.testing.assert_allclose(mixture.weight, [0.625, 0.125, 0.25], rtol=1e-15)
    assert mixture.max_relative_error is None
    parts = [(0.625, ltmd.GGX(0.5)), (0.125, ltmd.GGX(0.03)), (0.25, ltmd.Beckmann(0.1))]
    m = ltmd.GGX(0.3).sample(rng.random((100, 2)))
    for name, given in (("P22", SLOPES), ("D", m), ("Lambda", VIEWS), ("projected_area", VIEWS)):
        expected = sum(w * getattr(lobe, name)(given) for w, lobe in parts)
        np.testing.assert_allclose(getattr(mixture, name)(given), expected, rtol=1e-12, atol=1e-300)
        single = getattr(mixture, name)(given.astype(np.float32))
        np.testing.assert_allclose(single, expected, rtol=1e-4, atol=1e-30)


def test_float_is_finite_at_the_horizon():
    mixture = ltmd.LobeMixture(["ggx", "beckmann"], [0.5, 0.01], [1, 1])
    for z in (1e-3, 1e-12, 1e-30):
        m = np.array([1.0, 0.0, z], dtype=np.float32)
        assert np.isfinite(mixture.D(m)) and mixture.D(m) >= 0


def test_refusals():
    with pytest.raises(ValueError, match="0 lobes; 1 to 64"):
        ltmd.LobeMixture([], [], [])
    with pytest.raises(ValueError, match="65 lobes"):
        ltmd.LobeMixture(["ggx"] * 65, [0.1] * 65, [1] * 65)
    with pytest.raises(ValueError, match="one length"):
        ltmd.LobeMixture(["ggx"], [0.1, 0.2], [1])
    with pytest.raises(ValueError, match="'ggx' or 'beckmann', not 'phong'"):
        ltmd.LobeMixture(["phong"], [0.1], [1])
    for alpha, weight, name in ((0.0, 1, "alpha"), (0.1, -1, "weight"), (0.1, np.nan, "weight")):
        with pytest.raises(ValueError, match=name):
            ltmd.LobeMixture(["ggx"], [alpha], [weight])
    with pytest.raises(ValueError, match="positive, finite sum"):
        ltmd.LobeMixture(["ggx"], [0.1], [0])
    with pytest.raises(ValueError, match="1 lobes are Beckmann"):
        mixture = ltmd.LobeMixture(["ggx", "beckmann"], [0.1, 0.1], [1, 1])
        mixture.sample_bounded(direction(0.3), np.zeros(2))
    for arguments in ((0.1, 1.0, 0), (0.1, 1.0, 7), (2.0, 1.0), (0.1, 5.0)):
        with pytest.raises(ValueError, match=r"\["):
            ltmd.fit_lobes(*arguments)


@pytest.mark.parametrize("alpha", [1e-4, 0.01, 0.1, 0.6])
@pytest.mark.parametrize("gamma", [0.01, 0.5, 1.0, 1.7])
def test_ggx_lobes_are_gtr(alpha, gamma):
    exact = ltmd.GTR(alpha, gamma)
    lobes = ltmd.gtr_ggx_lobes(alpha, gamma, 40)
    np.testing.assert_allclose(lobes.Lambda(VIEWS), exact.Lambda(VIEWS), rtol=1e-10, atol=1e-20)
    few = ltmd.gtr_ggx_lobes(alpha, gamma, 16)
    np.testing.assert_allclose(few.G1(VIEWS), exact.G1(VIEWS), rtol=1e-6)


@pytest.mark.parametrize("alpha", [0.01, 0.1, 0.6])
@pytest.mark.parametrize("gamma", [0.5, 1.0, 1.7, 2.0, 2.5, 4.0])
def test_beckmann_lobes_are_gtr(alpha, gamma):
    """1F1 over 2F1 by its consequence; Beckmann lobes miss GTR's far tail."""
    exact = ltmd.GTR(alpha, gamma)
    lobes = ltmd.gtr_beckmann_lobes(alpha, gamma, 64)
    near = SLOPES[np.hypot(*SLOPES.T) < alpha]
    np.testing.assert_allclose(lobes.P22(near), exact.P22(near), rtol=1e-6)
    np.testing.assert_allclose(lobes.G1(VIEWS), exact.G1(VIEWS), rtol=2e-4)


# alpha, gamma, lobes -> the greatest error allowed
FIT_BOUNDS = {
    **{(alpha, gamma, 3): 0.01 for alpha in (0.1, 0.2, 0.5, 0.9) for gamma in (0.3, 1, 1.6, 1.9)},
    **{(0.01, gamma, 5): 0.01 for gamma in (0.3, 0.7, 1, 1.4, 1.7)},
    **{(0.01, gamma, 6): 0.005 for gamma in (0.3, 0.7, 1, 1.4, 1.7)},
    **{(0.001, gamma, 6): 0.03 for gamma in (0.3, 0.7, 1, 1.4, 1.7)},
    **{
        (alpha, gamma, lobes): bound
        for alpha, rows in {
            0.05: {2.2: (0.125, 0.065, 0.03, 0.015), 4.0: (0.19, 0.045, 0.0105, 0.003)},
            0.16: {2.2: (0.05, 0.02, 0.009, 0.005), 4.0: (0.235, 0.06, 0.015, 0.005)},
            0.25: {2.2: (0.025, 0.011, 0.005, 0.003), 3.0: (0.14, 0.06, 0.026, 0.011)},
            0.5: {2.2: (0.006, 0.003, 0.0015, 0.001), 3.0: (0.038, 0.016, 0.007, 0.004)},
        }.items()
        for gamma, row in rows.items()
        for lobes, bound in zip((3, 4, 5, 6), row, strict=True)
    },
}


@pytest.mark.parametrize("alpha, gamma, lobes", FIT_BOUNDS)
def test_fits_are_within_their_bounds(alpha, gamma, lobes):
    fit = ltmd.fit_lobes(alpha, gamma, lobes)
    error = p22_error(fit, ltmd.GTR(alpha, gamma), alpha)
    assert error <= FIT_BOUNDS[alpha, gamma, lobes]
    assert fit.max_relative_error == pytest.approx(error, rel=0.05, abs=4e-4)
    kinds = ["ggx"] * lobes if gamma <= 2 else ["ggx"] + ["beckmann"] * (lobes - 1)
    assert fit.kind == kinds


@pytest.mark.parametrize("alpha, gamma", [(0.3, 2.0), (0.05, 0.0), (1.0, 1.4), (1.0, 3.3)])
@pytest.mark.parametrize("lobes", [1, 3, 6])
def test_fits_are_exact_where_gtr_is_one_lobe(alpha, gamma, lobes):
    fit = ltmd.fit_lobes(alpha, gamma, lobes)
    assert fit.max_relative_error < 1e-12
    # With alpha 1 all lobes are one.
    np.testing.assert_allclose(fit.alpha, alpha if gamma == 2 else 1, rtol=1e-12)


@pytest.mark.parametrize("lobes", [1, 2, 3, 4, 5, 6])
def test_fits_are_continuous(lobes):
    """Neighbours 1e-6 apart in log alpha or gamma differ by as much, across nodes and gamma = 2."""
    step = 1e-6
    slopes = np.outer([0.0, 0.5, 1.0, 3.0, 30.0], [0.6, 0.8])
    for alpha in (1 - 1e-7, 0.56234, 0.3, 0.1, 0.0316228, 0.01, 1e-3):
        for gamma in (0.0, 0.25, 0.6, 1.0, 1.5, 2 - step / 2, 2.25, 3.0, 3.5 - step / 2):
            here = ltmd.fit_lobes(alpha, gamma, lobes).P22(alpha * slopes)
            for a, g in ((alpha * (1 - step), gamma), (alpha, gamma + step)):
                there = ltmd.fit_lobes(a, g, lobes).P22(alpha * slopes)
                # P22 goes like alpha to some power and like exp(gamma log alpha^2).
                assert np.max(abs(there / here - 1)) < step * (20 - 10 * np.log(alpha))


def test_the_table_is_what_the_script_fits():
    script = table_script()
    for half, n, k, j in ((0, 3, 5, 4), (1, 4, 8, 4)):
        alpha, gamma = script.node_alpha(half, k), script.node_gamma(half, j)
        fit = ltmd.fit_lobes(alpha, gamma, n)
        place = np.log(fit.alpha**2) - 2 * np.log(alpha)
        if half == 0:
            place = np.log(fit.alpha) / np.log(alpha)
        logs = np.log(fit.weight / script.factors(alpha, gamma, n))
        again = script.fit(alpha, gamma, place + 0.01, logs - logs[-1])
        np.testing.assert_allclose(again[0], place, atol=3e-3)
        np.testing.assert_allclose(again[1], logs - logs[-1], atol=1e-2)
        assert script.max_relative_error(alpha, gamma, *again) == pytest.approx(
            fit.max_relative_error, rel=0.05
        )


def test_shaders_have_the_librarys_table():
    library, shaders = (path.read_bytes() for path in table_script().OUTPUTS)
    assert library == shaders
