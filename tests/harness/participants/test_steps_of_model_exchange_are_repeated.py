"""Two halves of an oscillator, coupled by repetition of each step: solved by us as model exchange,
which returns to its states at the start of the step, or by themselves in co-simulation, the motion
is the same but for the tolerance of the solvers."""

import numpy as np
import pytest

from harness import Bench, Result
from tests.harness.simulation.fmus import needs_compiler

pytestmark = needs_compiler
TOLERANCE = 1e-9
MOST = 100 * TOLERANCE
"""As many steps of the solvers, a tolerance each, as a hundred communication steps take at least;
the motion is of the order of 1."""


def motion(kind: str, algorithm: str, version: int) -> Result:
    """A second of it, at communication steps of 10 ms."""
    bench = Bench(stop_time=1.0, step=0.01, algorithm=algorithm, fmi_version=version)
    for side, position in (("left", 0.5), ("right", -1.0)):
        bench.fmu(side, f"oscillator_{side}", interface_type=kind, tolerance=TOLERANCE,
                  start_values={"position": position})  # fmt: skip
    bench.connect("left.position", "right.left_position")
    bench.connect("left.velocity", "right.left_velocity")
    bench.connect("right.coupling_force", "left.coupling_force")
    return bench.run(in_process=True)


@pytest.mark.parametrize("version", [2, 3])
def test_it_is_that_of_co_simulation(version: int) -> None:
    here, itself = (
        motion(kind, "iterative", version) for kind in ("model-exchange", "co-simulation")
    )
    for name in itself.names:
        size = np.abs(itself[name]).max()
        assert size > 0.1
        assert np.abs(here[name] - itself[name]).max() <= MOST * max(1.0, size)


def test_without_repetition_it_is_another_one() -> None:
    """So the steps have been repeated."""
    repeated, once = (motion("model-exchange", a, 3) for a in ("iterative", "jacobi"))
    difference = np.abs(repeated["left.position"] - once["left.position"]).max()
    assert difference > 1000 * MOST
