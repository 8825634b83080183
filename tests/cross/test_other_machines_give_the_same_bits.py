"""A cross-compiled controller gives on other machines what it gives here.

Arithmetic is the same everywhere, to the last bit. What the step takes from the library of
mathematics (tan, exp, …) may differ there in the last place.
"""

from pathlib import Path

import numpy as np
import pytest

from tests.cross.machines import EMULATORS, HAS_ZIG, run_there
from tests.harness.export.blocks import InProcess, example, pid, random_inputs

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not HAS_ZIG, reason="needs ziglang"),
]
RUNNABLE = [
    pytest.param(
        name, marks=pytest.mark.skipif(emulator is None, reason=f"nothing here runs {name}")
    )
    for name, emulator in EMULATORS.items()
]


@pytest.mark.parametrize("platform", RUNNABLE)
@pytest.mark.parametrize("name", ["pid", "fuzzy_pid", "two_mass_controller"])
def test_arithmetic(platform: str, name: str, tmp_path: Path) -> None:
    block, sample_time = (pid(), 0.01) if name == "pid" else example(name)
    inputs = random_inputs(block, 500)
    loop = InProcess(block)
    expected = np.array([loop(row).copy() for row in inputs])
    assert np.ptp(expected[:, 0]) > 0.1
    np.testing.assert_array_equal(
        run_there(platform, block, sample_time, inputs, tmp_path), expected
    )
