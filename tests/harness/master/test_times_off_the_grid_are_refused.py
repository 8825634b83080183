"""Phases and stop times off the grid, and rates without a usable cycle, are errors that name both
numbers."""

import pytest

from harness.errors import TimingError
from harness.master.run import plan_system
from tests.harness.master.mock import MockFmu
from tests.harness.master.small_systems import MS, controller, fmu, system, wire


def plan(*parts: object, **more: object) -> None:
    plan_system(system(*parts, **more), {"plant": MockFmu()})  # type: ignore[arg-type]


def loop(period_ns: int, phase_ns: int = 0) -> tuple[object, ...]:
    return (
        controller(lambda time, y: y, period_ns, phase_ns),
        wire("plant.y", "controller.y"),
        wire("controller.u", "plant.u"),
    )


def test_phase_not_below_the_period() -> None:
    with pytest.raises(TimingError, match="phase 20 ms is not below its period 20 ms"):
        plan(fmu(), *loop(20 * MS, 20 * MS))


def test_negative_phase() -> None:
    with pytest.raises(TimingError, match="phase -10 ms is negative"):
        plan(fmu(), *loop(20 * MS, -10 * MS))


def test_stop_time_between_steps_names_the_nearest() -> None:
    with pytest.raises(TimingError, match=r"10 ms.*does not divide.*104 ms.*nearest.*100 ms"):
        plan(fmu(), stop_ns=104 * MS)


def test_the_nearest_stop_time_suits_all_fmus() -> None:
    """100 ms are no multiple of 7 ms, 98 ms none of 10 ms."""
    fmus = {"plant": MockFmu(), "other": MockFmu()}
    with pytest.raises(TimingError, match=r"other steps by 7 ms.*nearest stop time is 70 ms"):
        plan_system(system(fmu(), fmu("other", 7 * MS)), fmus)  # type: ignore[arg-type]


def test_rates_without_a_common_cycle() -> None:
    free = controller(lambda time: time, 9_999_991)
    with pytest.raises(
        TimingError, match=r"no cycle shorter.*controller 9\.999991 ms.*plant 10 ms"
    ):
        plan(fmu(step_ns=10 * MS), free)
