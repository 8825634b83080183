"""A plant under a PI controller at 0.01 s: solved by us as model exchange or by itself in
co-simulation, the loop is the same but for the tolerance of the solvers, and nears it with that."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness import Bench
from tests.harness.simulation.fmus import needs_compiler

pytestmark = needs_compiler

LOOPS = {
    "two_mass_drive": ("torque_reference", "motor_speed", 0.5, 1.0, 2.0),
    "hybrid_actuator": ("command", "force", 1000.0, 6.5e-5, 1.1e-4),
}
"""Input, output, what the output is asked to be, proportional and integral gain (per s)."""
STEP = 0.01
TOLERANCES = (1e-4, 1e-6, 1e-8)
MOST_STEPS = 1000
"""A solver errs by about a tolerance a step, and one that begins anew at each of a hundred samples
takes some ten steps for each; so many tolerances of the range the two may differ."""


class PI:
    """Forward rectangles, in plain Python."""

    def __init__(self, reference: float, kp: float, ki: float) -> None:
        """At rest."""
        self.reference, self.kp, self.ki, self.integral = reference, kp, ki, 0.0

    def step(self, time: float, y: float) -> float:
        """The control."""
        error = self.reference - y
        self.integral += STEP * self.ki * error
        return self.kp * error + self.integral


def closed_loop(plant: str, version: int, kind: str, tolerance: float) -> NDArray[np.float64]:
    """y and u at the samples of a second."""
    into, out, *gains = LOOPS[plant]
    bench = Bench(stop_time=1.0, step=STEP, fmi_version=version)
    bench.fmu("plant", plant, interface_type=kind, tolerance=tolerance)
    bench.controller("controller", PI(*gains))
    bench.connect(f"plant.{out}", "controller.y")
    bench.connect("controller.u", f"plant.{into}")
    result = bench.run()
    assert len(result.time) == 101
    return np.array([result[f"plant.{out}"], result["controller.u"]])


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("plant", sorted(LOOPS))
def test_the_difference_is_that_of_the_tolerance(plant: str, version: int) -> None:
    differences = []
    for tolerance in TOLERANCES:
        here = closed_loop(plant, version, "model-exchange", tolerance)
        itself = closed_loop(plant, version, "co-simulation", tolerance)
        assert np.ptp(itself[0]) > 0.1 * LOOPS[plant][2]
        differences.append((np.abs(here - itself).max(axis=1) / np.ptp(itself, axis=1)).max())
    assert differences[1] < differences[0] / 3
    assert differences[2] < differences[1] / 3
    assert all(d < MOST_STEPS * t for d, t in zip(differences, TOLERANCES, strict=True))
