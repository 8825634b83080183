"""A delay d brings the value of the source's sample t_k to its target at t_k + d exactly."""

import numpy as np
import pytest

from harness.errors import TimingError
from tests.harness.master.mock import MockFmu
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire

US = 1_000


def clocked(time: float, y: float) -> float:
    return round(time * 1e6)  # the sample instant in microseconds


def loop(delay_ns: int, period_ns: int, record_ns: int, **more: object):  # type: ignore[no-untyped-def]
    return system(
        fmu(step_ns=period_ns), controller(clocked, period_ns, start=-1.0),
        wire("plant.y", "controller.y"), wire("controller.u", "plant.u", delay_ns),
        stop_ns=8 * period_ns, record_ns=record_ns, **more,
    )  # fmt: skip


def test_100_us_at_500_us_sampling() -> None:
    plant = MockFmu()
    rows = run(loop(100 * US, 500 * US, 100 * US), {"plant": plant})
    steps = plant.instances[0].model.steps
    assert [round(h * 1e6) for _, h in steps] == [100, 400] * 8
    assert [t for t, _ in steps] == [(500 * k + d) * 1000 / 1e9 for k in range(8) for d in (0, 100)]
    now = rows.times // US
    expected = np.where(now < 100, -1, (now - 100) // 500 * 500)
    assert np.array_equal(rows["plant.u"], expected)


@pytest.mark.parametrize("samples", [1, 2, 5])
def test_whole_samples(samples: int) -> None:
    rows = run(loop(samples * 10 * MS, 10 * MS, 10 * MS), {"plant": MockFmu()})
    computed, applied = rows["controller.u"], rows["plant.u"]
    assert np.array_equal(applied[samples:], computed[:-samples])
    assert np.all(applied[:samples] == -1.0), "before the first arrival: the output's start value"


def test_longer_than_a_sample_and_no_multiple_of_it() -> None:
    rows = run(loop(23 * MS, 10 * MS, MS), {"plant": MockFmu()})
    now = rows.times // MS
    expected = np.where(now < 23, -1, (now - 23) // 10 * 10_000)
    assert np.array_equal(rows["plant.u"], expected)


def test_delayed_measurement_is_that_of_the_sample_even_where_the_plant_stands_in_between() -> None:
    delayed = system(
        fmu(), controller(lambda time, y: y, 5 * MS, name="reader"), controller(clocked),
        wire("plant.y", "reader.y", 5 * MS), wire("plant.y", "controller.y"),
        wire("controller.u", "plant.u", 3 * MS), record_ns=5 * MS,
    )  # fmt: skip
    rows = run(delayed, {"plant": MockFmu()})
    on_grid = rows["controller.y"][::2]  # y at 0, 10, 20 ms; the plant stands at 3, 13 ms as well
    assert np.array_equal(rows["reader.y"][1::2], on_grid[:-1])


def test_an_fmu_of_fixed_steps_refuses_arrivals_between_them() -> None:
    plant = MockFmu(can_handle_variable_step=False)
    with pytest.raises(TimingError, match=r"plant\.u/delay.*between the steps of plant.*10 ms"):
        run(loop(3 * MS, 10 * MS, MS), {"plant": plant})
    run(loop(20 * MS, 10 * MS, 10 * MS), {"plant": plant})
