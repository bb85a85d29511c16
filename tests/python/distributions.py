# SPDX-License-Identifier: Apache-2.0
"""Every distribution that the tests for all of them run on: name -> (distribution, slope scale)."""

import ltmd
import numpy as np

DISTRIBUTIONS = {
    "EllipsoidNDF turned": (ltmd.EllipsoidNDF.from_angles(0.6, 0.15, theta_z=0.4), 0.3),
    "EllipsoidNDF sheared": (ltmd.EllipsoidNDF([[0.4, 0.3, 0], [0, 0.2, 0], [0, 0, 1]]), 0.3),
    "GGX(0.01)": (ltmd.GGX(0.01), 0.01),
    "GGX(0.3)": (ltmd.GGX(0.3), 0.3),
    "GGX(1)": (ltmd.GGX(1.0), 1.0),
    "GGX(0.5, 0.1)": (ltmd.GGX(0.5, 0.1), 0.2),
    "Beckmann(0.05)": (ltmd.Beckmann(0.05), 0.05),
    "Beckmann(0.6)": (ltmd.Beckmann(0.6), 0.6),
    "Beckmann(0.4, 0.1)": (ltmd.Beckmann(0.4, 0.1), 0.2),
    "Tabulated(two scales)": (
        ltmd.Tabulated(lambda r: np.exp(-((r / 0.01) ** 2)) / 0.01**2 + 1 / (1 + r**2) ** 2),
        0.1,
    ),
    "GTR(0.04, 1.4)": (ltmd.GTR(0.04, 1.4), 0.04),
    "GTR(0.25, 2.2)": (ltmd.GTR(0.25, 2.2), 0.25),
    "GTR(0.16, 0.5)": (ltmd.GTR(0.16, 0.5), 0.3),
    "GTR(0.5, 4)": (ltmd.GTR(0.5, 4.0), 0.4),
    "fit_lobes(0.16, 2.5)": (ltmd.fit_lobes(0.16, 2.5), 0.16),
    "STD(0.3, 3)": (ltmd.STD(0.3, 3.0), 0.3),
    "Phong(20)": (ltmd.Phong(20.0), 0.3),
    "Sheen(0.3)": (ltmd.Sheen(0.3), 1.0),
    "Gauss(0.4)": (ltmd.Gauss(0.4), 0.4),
    "SchlickMDF(1)": (ltmd.SchlickMDF(1.0), 1.0),
    "SawickiDS(10)": (ltmd.SawickiDS(10), 0.4),
    "AshikhminShirley(10, 40)": (ltmd.AshikhminShirley(10, 40), 0.3),
}
