# SPDX-License-Identifier: Apache-2.0
import ltmd
import numpy as np
import pytest


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes more than a few seconds; left out by --fast")
    config.addinivalue_line("markers", "long: one of hundreds alike; run by --long alone")


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture(autouse=True)
def default_threads():
    yield
    ltmd.set_threads(0)
