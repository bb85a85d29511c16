# SPDX-License-Identifier: Apache-2.0
"""Put the tests' own helper module on the path, whatever folder pytest is started in."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))


def pytest_configure(config):
    config.addinivalue_line("markers", "long: too slow for every run; run by --long alone")
