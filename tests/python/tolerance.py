# SPDX-License-Identifier: Apache-2.0
"""Tolerances derived from float32 and the size of the values, never bare numbers."""

import numpy as np

EPS = float(np.finfo(np.float32).eps)


def assert_close(actual, expected, factor=100, scale=None):
    """Each row of `actual` within `factor` eps of `expected`, relative to its largest entry."""
    actual, expected = np.asarray(actual, float), np.asarray(expected, float)
    assert actual.shape == expected.shape
    assert np.isfinite(actual).all()
    if scale is None:
        scale = np.abs(expected).reshape(len(expected), -1).max(axis=1, initial=0)
    scale = np.broadcast_to(scale, len(expected))
    error = np.abs(actual - expected).reshape(len(expected), -1).max(axis=1, initial=0)
    worst = int(np.argmax(error - factor * EPS * scale)) if len(error) else 0
    assert (error <= factor * EPS * scale).all(), (
        f"row {worst}: {actual[worst]} is not {expected[worst]}: off by "
        f"{error[worst] / EPS / scale[worst]:.0f} eps, {factor} allowed"
    )


def assert_same_bits(actual, expected):
    assert actual.dtype == expected.dtype == np.float32
    assert actual.shape == expected.shape
    different = np.argwhere(actual.view(np.uint32) != expected.view(np.uint32))
    assert not len(different), f"{len(different)} values differ, first at {different[0]}"
