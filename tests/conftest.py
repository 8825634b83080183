"""Every run of the tests tries the same examples: hypothesis derives them from the tests alone.

What is built for them is built once, into one folder for all processes of the run: an FMU is known
there by its content, so it comes from the sources at hand.
"""

import os
import tempfile

import pytest
from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")


def pytest_configure(config: pytest.Config) -> None:
    if "PYTEST_XDIST_WORKER" not in os.environ:  # processes of xdist get the environment
        folder = tempfile.TemporaryDirectory(prefix="fmu-harness-tests-")
        config.add_cleanup(folder.cleanup)
        os.environ["FMU_HARNESS_CACHE"] = folder.name
