# SPDX-License-Identifier: Apache-2.0
"""Maps of the surface that are not linear act through their Jacobian."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

# The error of a five-point difference, step^4 f''''' / 30, meets its rounding, eps / step, here.
_STEP = 1e-3


def jacobian(
    warp: Callable[[NDArray[np.float64], NDArray[np.float64]], tuple[ArrayLike, ArrayLike]],
    u: ArrayLike,
    v: ArrayLike,
) -> NDArray[np.float64]:
    """The matrix M, float64[..., 2, 2], of a warp W(u, v) at points u, v: float[...].

    warp: a smooth function of two arrays that gives two arrays; it is evaluated at 8 points around
    each. Differences of fourth order, with an error about 1e-12 of the fifth derivative. Raises
    ValueError where the warp does not give two arrays of that shape, or is not finite.
    Source: microsurface-transformations, Fig. 1 and eq. 9.
    """
    u, v = np.broadcast_arrays(np.asarray(u, np.float64), np.asarray(v, np.float64))
    columns = []
    for along_u in (True, False):
        step = _STEP * np.maximum(1, np.abs(u if along_u else v))
        total = 0.0
        for offset, weight in ((-2, 1), (-1, -8), (1, 8), (2, -1)):
            moved = offset * step
            result = warp(u + moved, v) if along_u else warp(u, v + moved)
            if not (isinstance(result, tuple) and len(result) == 2):
                raise ValueError("the warp must give two arrays, W(u, v) = (u', v')")
            try:
                pair = np.stack(
                    [np.broadcast_to(np.asarray(x, np.float64), u.shape) for x in result]
                )
            except ValueError:
                raise ValueError(f"the warp must give two arrays of shape {u.shape}") from None
            if not np.all(np.isfinite(pair)):
                first = tuple(np.argwhere(~np.isfinite(pair).all(axis=0))[0])
                raise ValueError(f"the warp is not finite near (u, v) = ({u[first]}, {v[first]})")
            total = total + weight * pair
        columns.append(total / (12 * step))
    return np.moveaxis(np.stack(columns, axis=1), (0, 1), (-2, -1))
