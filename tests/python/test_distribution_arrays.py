# SPDX-License-Identifier: Apache-2.0
"""What all distributions do with arrays: results in memory that is given, any number of threads."""

import ltmd
import numpy as np
import pytest
from microfacet import MATRICES

COUNT = 9001  # more than one thread's share, and no multiple of any vector's width


def arguments(dtype):
    rng = np.random.default_rng(0)
    v, m = rng.normal(size=(2, COUNT, 3))
    v[:, 2], m[:, 2] = abs(v[:, 2]), abs(m[:, 2])
    v, m = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (v, m))
    return {k: a.astype(dtype) for k, a in zip("vmu", (v, m, rng.random((COUNT, 2))), strict=True)}


METHODS = {
    "P22": "u", "D": "m", "Lambda": "v", "G1": "v", "projected_area": "v", "sample": "u",
    "pdf": "m", "sample_visible": "vu", "pdf_visible": "vm", "sample_bounded": "vu",
    "pdf_bounded": "vm", "sample_mixed": "vu", "pdf_mixed": "vm",
}  # fmt: skip
each_method = pytest.mark.parametrize("method", METHODS)
GTR = ltmd.GTR(0.1, 1.4)


@each_method
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_results_go_to_out(method, dtype):
    a = arguments(dtype)
    given = [a[k] for k in METHODS[method]]
    call = getattr(GTR, method)
    expected = call(*given)
    out = np.full_like(expected, np.nan)
    assert call(*given, out=out) is out
    np.testing.assert_array_equal(out, expected)


@each_method
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_same_bits_with_any_number_of_threads(method, dtype):
    a = arguments(dtype)
    results = []
    for count in (1, 3):
        ltmd.set_threads(count)
        results.append(getattr(GTR, method)(*[a[k] for k in METHODS[method]]))
    np.testing.assert_array_equal(*results)


def test_bounded_normals_under_a_matrix_and_of_a_mixture_go_to_out():
    a = arguments(np.float32)
    for d in (GTR, ltmd.fit_lobes(0.1, 1.4)):
        for method, other in (("sample_bounded", "u"), ("pdf_bounded", "m")):
            expected = getattr(d, method)(a["v"], a[other], MATRICES["shear"])
            out = np.empty_like(expected)
            getattr(d, method)(a["v"], a[other], MATRICES["shear"], out=out)
            np.testing.assert_array_equal(out, expected)


@pytest.mark.parametrize(
    "out, error, message",
    [
        ([0.0] * 5, TypeError, "out must be a NumPy array of float32"),
        (np.empty(5), TypeError, "out must be a NumPy array of float32"),
        (np.empty(4, np.float32), ValueError, r"out must have shape \(5,\), not \(4,\)"),
        (np.empty((5, 1), np.float32), ValueError, r"out must have shape \(5,\), not \(5, 1\)"),
        (np.empty(10, np.float32)[::2], ValueError, "writable and C-contiguous"),
        (np.broadcast_to(np.float32(0), 5), ValueError, "writable and C-contiguous"),
    ],
)
def test_refuses_an_out_that_does_not_fit(out, error, message):
    with pytest.raises(error, match=message):
        GTR.D(np.zeros((5, 3), np.float32), out=out)


def test_refuses_an_out_that_shares_memory_with_an_argument():
    memory = np.zeros(40, np.float32)
    v, m = memory[:15].reshape(5, 3), np.ones((5, 3), np.float32)
    for given in ((v, m), (m, v)):
        with pytest.raises(ValueError, match="out shares memory with an argument"):
            GTR.pdf_visible(*given, out=memory[14:19])
    assert GTR.pdf_visible(v, m, out=memory[15:20]).shape == (5,)
