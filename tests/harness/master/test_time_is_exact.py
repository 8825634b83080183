"""Integer time: no drift, decimal instants, no step past the stop time, any start time."""

from fractions import Fraction

import numpy as np
import pytest
from numba import cfunc

from harness.clock import to_nanoseconds, to_seconds
from tests.harness.master.mock import Input, MockFmu, MockInstance, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system


@cfunc("int32(CPointer(float64), float64, float64, int32)")
def count(memory, time, step, keep):  # type: ignore[no-untyped-def]
    """fmi2DoStep of an instance that is three numbers: steps so far, the last time and step."""
    memory[0] += 1.0
    memory[1] = time
    memory[2] = step
    return 0


class Counter(MockInstance):
    """Counts its steps in compiled code, for a million of them."""

    def __init__(self, fmu: MockFmu, name: str) -> None:
        super().__init__(fmu, name)
        self.memory = np.zeros(3)
        self.handle = self.memory.ctypes.data

    def address(self, name: str) -> int:
        return int(count.address) if name == "DoStep" else super().address(name)


def test_a_million_steps_of_a_tenth_of_a_second_end_exactly(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plant = MockFmu((), ())
    counter = Counter(plant, "plant")
    monkeypatch.setattr(plant, "instantiate", lambda *_, **__: counter)
    slow = controller(lambda time: time, 10**11)
    rows = run(system(fmu(step_ns=100 * MS), slow, stop_ns=10**14, record_ns=10**11),
               {"plant": plant})  # fmt: skip
    assert rows.times[-1] == 10**14 and rows["controller.u"][-1] == 100_000.0
    assert counter.memory.tolist() == [1_000_000.0, 99_999.9, 0.1], "not 99 999.900 000 1"


@pytest.mark.parametrize("start", [0.0, 0.3, 1234.5, -0.7])
@pytest.mark.parametrize("step", [0.01, 0.1, 1e-4, 0.007])
def test_do_step_and_rows_get_the_double_nearest_to_the_instant(start: float, step: float) -> None:
    plant = MockFmu(fmi_major=3, inputs=(Input("u", "Float64"),), outputs=(Output("y", "Float64"),))
    t0, h = to_nanoseconds(start, "start"), to_nanoseconds(step, "step")
    parts = fmu(step_ns=h)
    rows = run(system(parts, start_ns=t0, stop_ns=t0 + 100 * h, record_ns=h), {"plant": plant})
    exact = [float(Fraction(t0 + k * h, 10**9)) for k in range(101)]
    steps = plant.instances[0].model.steps
    assert [t for t, _ in steps] == exact[:-1]
    assert rows.seconds.tolist() == exact
    assert {width for _, width in steps} == {step}


def test_no_step_passes_the_stop_time_and_the_last_row_is_at_it() -> None:
    plant = MockFmu()
    rows = run(system(fmu(), stop_ns=70 * MS), {"plant": plant})
    time, width = plant.instances[0].model.steps[-1]
    assert Fraction(str(time)) + Fraction(str(width)) == Fraction(7, 100)
    assert rows.times.tolist() == [k * 10 * MS for k in range(8)]


def test_rows_have_an_interval_of_their_own() -> None:
    every = run(system(fmu()), {"plant": MockFmu()})
    third = run(system(fmu(), record_ns=30 * MS), {"plant": MockFmu()})
    finer = run(system(fmu(), record_ns=5 * MS), {"plant": MockFmu()})
    assert third.times.tolist() == [0, 30 * MS, 60 * MS, 90 * MS]
    assert np.array_equal(third.rows, every.rows[::3])
    assert np.array_equal(finer.rows[::2], every.rows)
    assert np.array_equal(finer.rows[1::2], every.rows[:-1]), "held between the steps"


def test_the_run_begins_at_its_start_time() -> None:
    plant = MockFmu()
    rows = run(system(fmu(), start_ns=5 * MS, stop_ns=45 * MS), {"plant": plant})
    assert rows.times.tolist() == [k * MS for k in (5, 15, 25, 35, 45)]
    assert plant.instances[0].calls[0] == f"Enter(0.005, {to_seconds(45 * MS)!r}, None)"
