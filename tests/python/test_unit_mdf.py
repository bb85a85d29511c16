# SPDX-License-Identifier: Apache-2.0
"""Unit forms as Table 1 of microfacet-distribution-conversion prints them, and far from 1."""

import pathlib
import re
import typing

import ltmd
import numpy as np
import pytest

EPS = np.finfo(float).eps


def beckmann(m, beta):
    return np.exp(-(np.tan(beta) ** 2) / m**2) / np.cos(beta) ** 4


def gauss(m, beta):
    return np.exp(-(beta**2) / m**2)


def gtr(c, beta, gamma=2):
    return (c**2 / (np.cos(beta) ** 2 * (c**2 - 1) + 1)) ** gamma


def blinn_phong(n, beta):
    return np.cos(beta) ** n


def schlick(m, beta):
    cosine = np.cos(beta)
    x = cosine + m - 1
    unit = m**5 * x / (cosine * (m * x**2 - x**2 + m**2) ** 2)
    return np.where(cosine > 1 - m, unit, 0)


def sawicki(n, beta):
    cosine = np.cos(beta)
    return 256 * cosine / ((1 - n) * cosine + n + 3) ** 4


TABLE_1 = {
    "beckmann_alpha": beckmann,
    "gauss_m": gauss,
    "ggx_alpha": gtr,
    "blender_roughness": lambda r, beta: gtr(r**2, beta),
    "gtr_alpha": gtr,
    "phong_exponent": blinn_phong,
    "ashikhmin_shirley_n": blinn_phong,
    "schlick_m": schlick,
    "sawicki_n": sawicki,
}
EXPONENTS = ("phong_exponent", "ashikhmin_shirley_n", "sawicki_n")


def test_names():
    assert tuple(TABLE_1) == ltmd.MDF_PARAMETERS
    stubs = pathlib.Path(ltmd.__file__).with_name("_ltmd.pyi").read_text()
    listed = re.search(r"^MdfParameter = (Literal\[.*?\])$", stubs, re.MULTILINE | re.DOTALL)[1]
    assert typing.get_args(eval(listed, {"Literal": typing.Literal})) == ltmd.MDF_PARAMETERS


@pytest.mark.parametrize("name", TABLE_1)
def test_table_1(name):
    beta = np.linspace(-1.57, 1.57, 629)
    for value in (1, 3.5, 40, 1000) if name in EXPONENTS else (0.1, 0.3, 0.7, 0.95):
        expected = TABLE_1[name](value, beta)
        # The printed forms lose digits where 1 - cos is small, the more the sharper the peak.
        tolerance = 20 * EPS * (value if name in EXPONENTS else value**-4)
        np.testing.assert_allclose(
            ltmd.unit_mdf(name, value, beta), expected, rtol=tolerance, atol=tolerance
        )
        assert ltmd.unit_mdf(name, value, 0.0) == 1
        np.testing.assert_array_equal(ltmd.unit_mdf(name, value, [np.pi / 2, -2, 7.0]), 0)


def test_the_gamma_of_gtr():
    beta = np.linspace(0, 1.5, 100)
    for gamma in (0.5, 1, 3.5):
        actual = ltmd.unit_mdf("gtr_alpha", 0.3, beta, gamma)
        np.testing.assert_allclose(actual, gtr(0.3, beta, gamma), rtol=1e-13)
        unused = ltmd.unit_mdf("ggx_alpha", 0.3, beta, gamma)
        np.testing.assert_allclose(unused, gtr(0.3, beta), rtol=1e-13)


def test_sharp_peaks_are_those_of_the_limit():
    """For m -> 0 shapes are functions of x = beta / m; corrections are of order m^2 x^4."""
    m = 1e-5
    x = np.linspace(0, 3, 61)
    q = x**2 / 2
    bell = np.exp(-(x**2))
    limits = {
        "beckmann_alpha": (m, bell),
        "gauss_m": (m, bell),
        "ggx_alpha": (m, (1 + x**2) ** -2),
        "phong_exponent": (2 / m**2, bell),
        "sawicki_n": (2 / m**2, (1 + q / 2) ** -4),
    }
    for name, (value, expected) in limits.items():
        actual = ltmd.unit_mdf(name, value, x * m)
        np.testing.assert_allclose(actual, expected, rtol=100 * m**2 + 100 * EPS, err_msg=name)
    # Schlick's is wider: it reaches to versine = m.
    q = np.linspace(0, 0.99, 50)
    beta = 2 * np.arcsin(np.sqrt(q * m / 2))
    y = 1 - q
    expected = m**2 * y / (1 - y**2 + m * y**2) ** 2
    actual = ltmd.unit_mdf("schlick_m", m, beta)
    np.testing.assert_allclose(actual[1:], expected[1:], rtol=10 * m)
    assert actual[0] == 1


def test_schlick_is_0_outside_its_range():
    edge = np.arccos(1 - 0.3)
    beta = [edge * 0.999, edge * 1.001, 1.5]
    inside, *outside = ltmd.unit_mdf("schlick_m", 0.3, beta)
    assert 0 < inside < 0.01 and outside == [0, 0]


def test_types_and_shapes():
    block = np.full((2, 3), 0.1, np.float32)
    assert ltmd.unit_mdf("ggx_alpha", 0.3, block).dtype == np.float32
    assert ltmd.unit_mdf("ggx_alpha", 0.3, block).shape == (2, 3)
    assert ltmd.unit_mdf("ggx_alpha", 0.3, [0, 1]).dtype == np.float64
    assert ltmd.unit_mdf("ggx_alpha", 0.3, np.empty(0)).shape == (0,)
    turned = np.arange(6.0).reshape(2, 3).T / 6
    expected = gtr(0.3, turned)
    np.testing.assert_allclose(ltmd.unit_mdf("ggx_alpha", 0.3, turned), expected, rtol=1e-13)


def test_refuses_in_words():
    with pytest.raises(ValueError, match="'roughness'.*beckmann_alpha.*sawicki_n"):
        ltmd.unit_mdf("roughness", 0.3, 0.1)
    for name in ltmd.MDF_PARAMETERS:
        for value in (0, -1, 1e14, np.nan):
            with pytest.raises(ValueError, match=rf"{name} is .*\[.*\]"):
                ltmd.unit_mdf(name, value, np.empty(0))
    for gamma in (0.4, 17, np.nan):
        with pytest.raises(ValueError, match=r"gamma is .*\[0.5, 16\]"):
            ltmd.unit_mdf("gtr_alpha", 0.3, 0.1, gamma)
    with pytest.raises(TypeError, match="beta"):
        ltmd.unit_mdf("ggx_alpha", 0.3, np.arange(3))
