"""The lead experiment, exported as an .ssp, under the tools that read such packages.

All of them step all FMUs at once: our loop with a delay of one sample on the wire from the
controller to the plant. Ecos and FMPy keep the length of a step as it was given, libcosim's
differs in the last place unless the step is a power of two.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.peers.ssp_loops import experiment, exported, ours, theirs
from tests.peers.tools import skip_without

STEPS = 100
pytestmark = pytest.mark.filterwarnings("ignore:in other tools")


@pytest.fixture(params=["fmpy", "ecos", "libcosim"])
def tool(request: pytest.FixtureRequest) -> str:
    skip_without(request.param)
    return str(request.param)


@pytest.mark.parametrize(
    ("variant", "step", "portable"),
    [
        ("pid", 0.01, False),
        ("pid", 2.0**-7, False),
        ("pid", 0.01, True),
        pytest.param("robust_ekf", 0.01, False, marks=pytest.mark.slow),
    ],
)
def test_the_loop_with_one_sample_of_delay(
    tool: str, variant: str, step: float, portable: bool, tmp_path: Path
) -> None:
    stop = STEPS * step
    package = exported(experiment(2, stop, step=step, portable=portable), variant, tmp_path)
    expected = ours(experiment(2, stop, step=step, delay=step), variant)
    found = theirs(tool, package, step, STEPS)
    assert np.ptp(expected[:, 2]) > 1000.0  # N
    if tool == "libcosim" and step == 0.01:
        assert np.all(np.abs(found - expected) <= 1e-14 * np.abs(expected).max(axis=0))
    else:
        assert np.array_equal(found, expected)


def test_start_values_reach_the_plant(tool: str, tmp_path: Path) -> None:
    if tool == "fmpy":
        pytest.skip("FMPy takes start values from its caller, not from the package")
    plant = {"fmu": "hybrid_actuator", "start_values": {"environment_position": 0.0005}}
    changed = experiment(2, 0.3, components={"plant": plant}, delay=0.01)
    expected, others = ours(changed, "pid"), ours(experiment(2, 0.3, delay=0.01), "pid")
    found = theirs(tool, exported(changed, "pid", tmp_path), 0.01, 30)
    assert np.abs(expected - others).max() > 1.0
    assert np.abs(found - expected).max() < 1e-9
