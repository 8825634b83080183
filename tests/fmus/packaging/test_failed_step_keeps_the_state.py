"""x' = x^2 from 1 escapes at t = 1: that step is an Error, its reason is logged, x stays."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.instances import Instance
from tests.fmus.packaging.plants import finite_escape

H = 0.3


@pytest.fixture
def failed(new_instance: NewInstance, version: int) -> Instance:
    """Three good steps to 0.9, then the one that fails."""
    instance = new_instance(finite_escape, version)
    assert np.allclose(instance.run(["x"], 3, H)[:, 0], [1 / 0.7, 2.5, 10.0], rtol=1e-4)
    instance.before = instance.get("time", "x", "y", "der(x)")
    with pytest.raises(FMICallException, match="status 3"):
        instance.step(3, H)
    return instance


def test_values_are_those_before_the_step(failed: Instance) -> None:
    assert failed.get("time", "x", "y", "der(x)") == failed.before


def test_the_log_says_when_what_and_why(failed: Instance) -> None:
    (text,) = failed.texts("logStatusError")
    assert "DoStep" in text and " 0.9 s" in text and "'x'" in text
    assert "smallest substep" in text
    assert float(text.split("failed at ")[1].split(" s")[0]) == pytest.approx(1.0, abs=1e-4)


def test_no_further_step_without_a_new_state(failed: Instance) -> None:
    with pytest.raises(FMICallException):
        failed.step(3, 0.01)
    assert "'failed'" in failed.texts("logStatusError")[-1]


def test_reset_revives(failed: Instance) -> None:
    failed.fmu.reset()
    failed.initialize()
    failed.step(0, H)
    assert failed.get("x") == pytest.approx([1 / 0.7], rel=1e-4)


def test_a_stored_state_revives_and_continues_bit_equal(
    new_instance: NewInstance, version: int
) -> None:
    instance = new_instance(finite_escape, version)
    instance.run(["x"], 3, H)
    stored = instance.fmu.getFMUState()
    with pytest.raises(FMICallException):
        instance.step(3, H)
    instance.fmu.setFMUState(stored)
    instance.fmu.doStep(currentCommunicationPoint=3 * H, communicationStepSize=0.05)
    other = new_instance(finite_escape, version)
    other.run(["x"], 3, H)
    other.fmu.doStep(currentCommunicationPoint=3 * H, communicationStepSize=0.05)
    assert instance.get("x") == other.get("x")
    instance.fmu.freeFMUState(stored)


def test_derivatives_not_finite_at_the_start_are_refused(
    new_instance: NewInstance, version: int
) -> None:
    instance = new_instance(finite_escape, version, start=False)
    instance.set(x=1e200)
    with pytest.raises(FMICallException):
        instance.initialize()
    assert "der(x) is inf" in instance.texts("logStatusError")[0]
