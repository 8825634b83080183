"""What is built runs from its own start values, or is not built and says why."""

import pytest

from controllers.core.block import Array, Block, Signal
from harness.errors import FmuError
from harness.export.controller import controller_fmu
from harness.fmi.fmu import Fmu
from tests.harness.export.blocks import EXAMPLES, example


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_controller(name: str) -> None:
    block, sample_time = example(name)
    path = controller_fmu(block, name, sample_time, certified=False)
    with Fmu(path) as fmu, fmu.instantiate(name) as instance:
        instance.enter_initialization_mode(0.0, None, None)
        instance.exit_initialization_mode()
        for k in range(20):
            instance.do_step(k * sample_time, sample_time)
        instance.terminate()


def reciprocal_step(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = 1.0 / u[0] if u[0] != 0.0 else float("nan")


def reciprocal(start: float) -> Block:
    return Block((Signal("u", start=start),), (Signal("y"),), reciprocal_step)


def test_one_that_cannot_start_is_not_built(version: int) -> None:
    with pytest.raises(FmuError, match=r"does not run from its own start values.*output 'y' is"):
        controller_fmu(reciprocal(0.0), "reciprocal", 0.01, version)
    assert controller_fmu(reciprocal(0.5), "reciprocal", 0.01, version).exists()
