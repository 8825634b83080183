"""A portable FMU of a block computes the samples that are due, whatever steps it is asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from harness.errors import FmuError
from harness.export.controller import controller_fmu
from harness.fmi.fmu import Fmu
from tests.harness.export.blocks import EXAMPLES, example

TS = 0.25  # a binary fraction, so that sums of steps are exact


@pytest.fixture(scope="module", params=[2, 3], ids=["FMI 2", "FMI 3"])
def pid(request: pytest.FixtureRequest) -> Path:
    return controller_fmu(example("pid")[0], "pid_test", TS, request.param, portable=True)


def run(path: Path, steps: list[float]) -> list[tuple[float, float]]:
    """(time, u) after each step, with the reference at 1000 + time."""
    rows, time = [], 0.0
    with Fmu(path) as fmu, fmu.instantiate("pid") as instance:
        instance.enter_initialization_mode(0.0, None, None)
        instance.exit_initialization_mode()
        for step in steps:
            instance.set({"reference": 1000.0 + time, "measured": 3.0})
            instance.do_step(time, step)
            time += step
            rows.append((time, float(instance.get("u"))))
    return rows


def held(steps: list[float]) -> list[float]:
    """What the block itself holds after each step: samples due in [t, t + h), inputs of t."""
    block = example("pid")[0]
    p, x = block.parameters.copy(), block.state.copy()
    u, y = np.zeros(len(block.inputs)), np.array([s.start for s in block.outputs])
    names = [s.name for s in block.inputs]
    u[names.index("measured")] = 3.0
    found, time, sample = [], 0.0, 0
    for step in steps:
        u[names.index("reference")] = 1000.0 + time
        while sample * TS < time + step:
            block.step(p, x, u, y)
            sample += 1
        time += step
        found.append(float(y[0]))
    return found


@pytest.mark.parametrize(
    "steps",
    [[TS] * 8, [TS / 2] * 16, [2 * TS] * 4, [TS / 4, TS / 2, TS, 3 * TS, TS / 8, TS / 8] * 3],
    ids=["its own", "half", "double", "mixed"],
)
def test_samples_are_those_that_are_due(pid: Path, steps: list[float]) -> None:
    assert [u for _, u in run(pid, steps)] == held(steps)


def test_its_whole_state_is_stored_and_restored(pid: Path) -> None:
    with Fmu(pid) as fmu, fmu.instantiate("pid") as instance:
        instance.enter_initialization_mode(0.0, None, None)
        instance.exit_initialization_mode()

        def go(first: int) -> list[float]:
            found = []
            for k in range(first, first + 5):
                instance.set({"reference": 500.0 * k})
                instance.do_step(k * TS, TS)
                found.append(float(instance.get("u")))
            return found

        go(0)
        state = instance.get_state()
        expected = go(5)
        instance.set_state(state)
        assert go(5) == expected
        instance.free_state(state)


def test_two_different_ones_live_in_one_process(pid: Path) -> None:
    """Modules of the same name would be shared, silently with wrong numbers."""
    other = controller_fmu(example("lq_regulator")[0], "lq_test", TS, portable=True)
    alone = run(pid, [TS] * 4)
    with Fmu(other) as fmu, fmu.instantiate("other") as instance:
        instance.enter_initialization_mode(0.0, None, None)
        instance.exit_initialization_mode()
        assert run(pid, [TS] * 4) == alone


@pytest.mark.parametrize("name", ["time", "parameters.sample_time"])
def test_what_is_part_of_the_design_cannot_be_set(pid: Path, name: str) -> None:
    """A refusal would be Fatal for its library, so the next step says it."""
    with Fmu(pid) as fmu, fmu.instantiate("pid") as instance:
        instance.enter_initialization_mode(0.0, None, None)
        instance.exit_initialization_mode()
        instance.set({name: 1.0})
        with pytest.raises(FmuError, match=r"returned Discard|was refused.*cannot be set"):
            instance.do_step(0.0, TS)
        instance.do_step(0.0, TS)


@pytest.mark.parametrize("version", [2, 3], ids=["FMI 2", "FMI 3"])
@pytest.mark.parametrize("case", EXAMPLES)
def test_fmpy_finds_nothing_to_say(case: str, version: int) -> None:
    path = controller_fmu(example(case)[0], case, example(case)[1], version, portable=True)
    assert validate_fmu(str(path)) == []
