# SPDX-License-Identifier: Apache-2.0
"""A library of one Blender version renders the same in the other: linked, appended, overridden."""

import numpy as np
import pytest
from blender_process import run
from test_versions import LIBRARY, USE


@pytest.mark.parametrize(("maker", "user"), [("4.5", "5.2"), ("5.2", "4.5")])
def test_libraries_of_the_other_version(tmp_path, maker, user):
    path = str(tmp_path / "library.blend")
    run(LIBRARY, arguments={"path": path}, blender=maker)
    used = run(USE, arguments={"path": path}, blender=user)
    # The same Blender renders a copy made by itself: versions differ by their random numbers.
    own = str(tmp_path / "own.blend")
    made = run(LIBRARY, arguments={"path": own}, blender=user)
    for name in ("Cube", "New"):
        for way in ("link", "append", "override"):
            apart = np.abs(np.array(used[f"{way} {name}"]) - np.array(made[name])).max()
            assert apart < 1e-4 * np.max(made[name]), (way, name, apart)
