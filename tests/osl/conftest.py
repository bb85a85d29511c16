# SPDX-License-Identifier: Apache-2.0
"""The child-process helper of the Blender tests serves the shader tests too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "blender"))


def pytest_configure(config):
    config.addinivalue_line("markers", "long: too slow for every run; run by --long alone")
