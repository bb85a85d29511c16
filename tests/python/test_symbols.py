# SPDX-License-Identifier: Apache-2.0
"""Inside Blender, which has its own OpenEXR loaded, our module must show none of its parts."""

import shutil
import subprocess
import sys

import ltmd._ltmd
import pytest


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads ELF symbols")
def test_the_module_shows_its_entry_point_alone():
    nm = shutil.which("nm")
    if nm is None:
        pytest.fail("nm (binutils) was not found")
    table = subprocess.run(
        [nm, "-D", "--defined-only", ltmd._ltmd.__file__],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert [line.split()[-1] for line in table.splitlines()] == ["PyInit__ltmd"]
