"""Illegal calls change nothing and say why; a stored state continues bit for bit."""

from typing import Any

import numpy as np
import pytest

from controllers.core.block import Array, Block, Signal
from tests.fmus.packaging.instances import Instance
from tests.harness.export.blocks import InProcess, counter, pid
from tests.harness.export.conftest import NewInstance


def refusal(instance: Instance, **values: float) -> str:
    with pytest.raises(Exception, match=r"status 3|error"):
        instance.set(**values)
    return instance.texts("logStatusError")[-1]


def test_what_may_be_set_when(version: int, new_instance: NewInstance) -> None:
    instance = new_instance(counter(), version, start=False, logging=True)
    names = {"state.count": 10.0, "count": 5.0, "parameters.increment": 2.0}
    instance.enter_initialization()
    instance.set(**names)
    assert "part of the design" in refusal(instance, **{"parameters.unused": 1.0})
    instance.fmu.exitInitializationMode()
    assert instance.get("count") == [5.0]
    instance.step(0, 0.01)
    assert instance.get("count") == [12.0]
    assert "after initialization" in refusal(instance, **{"state.count": 0.0})
    assert "after initialization" in refusal(instance, count=0.0)
    instance.set(**{"parameters.increment": 0.5})
    instance.step(1, 0.01)
    assert instance.get("count", "state.count") == [12.5, 12.5]
    assert "finite" in refusal(instance, u=np.inf)


def fragile_step(p: Array, x: Array, u: Array, y: Array) -> None:
    x[0] += 1.0
    y[0] = x[0]
    if u[0] > 1.0:
        y[0] = np.nan


def fragile() -> Block:
    return Block(
        (Signal("u"),), (Signal("y"),), fragile_step, state=np.zeros(1), state_names=("n",)
    )


def test_nan_fails_the_step_and_keeps_the_values(version: int, new_instance: NewInstance) -> None:
    instance = new_instance(fragile(), version, logging=True)
    instance.step(0, 0.01)
    instance.set(u=2.0)
    with pytest.raises(Exception, match=r"status 3|error"):
        instance.step(1, 0.01)
    text = instance.texts("logStatusError")[-1]
    assert "the sample at 0.01 s failed: output 'y' is nan" in text
    assert instance.get("y", "state.n") == [1.0, 1.0]


def stored(instance: Instance) -> Any:
    get = instance.fmu.getFMUState if instance.version == 3 else instance.fmu.getFMUstate
    return get()


def restore(instance: Instance, state: Any) -> None:
    set_ = instance.fmu.setFMUState if instance.version == 3 else instance.fmu.setFMUstate
    set_(state)


def test_a_stored_state_continues_bit_for_bit(version: int, new_instance: NewInstance) -> None:
    block = pid()
    instance, loop = new_instance(block, version), InProcess(block)
    inputs = np.random.default_rng(1).standard_normal((60, 2))

    def rows(first: int, last: int) -> list[list[float]]:
        found = []
        for k in range(first, last):
            instance.set(reference=inputs[k, 0], measured=inputs[k, 1])
            instance.step(k, 0.01)
            found.append(instance.get(*[s.name for s in block.outputs]))
        return found

    rows(0, 20)
    state = stored(instance)
    once = rows(20, 60)
    restore(instance, state)
    assert rows(20, 60) == once
    expected = [loop(row).tolist() for row in inputs]
    assert once == expected[20:]


def test_reset_is_a_fresh_start(version: int, new_instance: NewInstance) -> None:
    instance = new_instance(counter(), version)
    instance.step(0, 0.01)
    instance.fmu.reset()
    instance.initialize()
    assert instance.get("count", "state.count", "u") == [-1.0, 0.0, 0.25]
