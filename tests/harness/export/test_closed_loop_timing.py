"""A controller FMU closes the loop as the block does: at once where it steps first, one
communication step later where all FMUs step together."""

from pathlib import Path

import numpy as np
import pytest

from controllers.pid.pid import PID
from harness.bench import Bench
from harness.export.controller import controller_fmu
from harness.results.result import Result

STEP = 0.01
CONTROLLER = PID(kp=2e-4, ki=1e-3, u_min=-5.0, u_max=5.0)


def loop(controller: Path | PID, algorithm: str, delay: float = 0.0) -> Result:
    """Force control of the hybrid actuator for 100 samples."""
    bench = Bench(stop_time=1.0, step=STEP, algorithm=algorithm)
    if isinstance(controller, Path):
        bench.fmu("controller", controller)
    else:
        bench.controller("controller", controller)
    bench.fmu("plant", "hybrid_actuator")
    bench.signal("reference", "step", time=0.1, final=2000.0)
    bench.connect("reference.value", "controller.reference")
    bench.connect("plant.force", "controller.measured")
    bench.connect("controller.u", "plant.command", delay=delay)
    return bench.run()


@pytest.fixture
def inside() -> Result:
    return loop(CONTROLLER, "jacobi")


def fmu(version: int) -> Path:
    return controller_fmu(CONTROLLER.block(STEP), "controller", STEP, version)


def test_stepped_first_it_adds_no_delay(version: int, inside: Result) -> None:
    outside = loop(fmu(version), "gauss-seidel")
    assert np.ptp(inside["plant.force"]) > 1000.0
    np.testing.assert_array_equal(outside["plant.force"], inside["plant.force"])


def test_stepped_together_it_adds_one_step(version: int) -> None:
    outside, delayed = loop(fmu(version), "jacobi"), loop(CONTROLLER, "jacobi", delay=STEP)
    np.testing.assert_array_equal(outside["plant.force"], delayed["plant.force"])
