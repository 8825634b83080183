"""A plant of 10 ms and a controller of 7 ms run by the calendar of their common multiple: each at
its own multiples, rows at theirs, and each sees what the other had at its last instant."""

import pytest

from harness.master.plan.actions import Compute, Record, Step
from harness.master.run import plan_system
from tests.harness.master.mock import MockFmu
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire


def loop(function, phase_ns: int = 0, **more: object):  # type: ignore[no-untyped-def]
    return system(
        fmu(), controller(function, 7 * MS, phase_ns), wire("plant.y", "controller.y"),
        wire("controller.u", "plant.u"), **{"stop_ns": 140 * MS, **more},
    )  # fmt: skip


@pytest.mark.parametrize("phase_ms", [0, 3])
def test_the_calendar_is_the_union_of_the_multiples(phase_ms: int) -> None:
    whole = loop(lambda time, y: y, phase_ms * MS, record_ns=35 * MS)
    plan = plan_system(whole, {"plant": MockFmu()})  # type: ignore[arg-type]
    controls, steps, rows = set(range(phase_ms, 70, 7)), set(range(0, 70, 10)), {0, 35}
    assert plan.cycle_ns == 70 * MS
    assert [i.offset_ns for i in plan.instants] == [t * MS for t in sorted(controls | steps | rows)]

    def instants(kind: type) -> set[int]:
        found = (i for i in plan.instants if any(isinstance(a, kind) for a in i.actions))
        return {i.offset_ns // MS for i in found}

    assert (instants(Compute), instants(Step), instants(Record)) == (controls, steps, rows)
    assert {a.step_ns for i in plan.instants for a in i.actions if isinstance(a, Step)} == {10 * MS}


def test_each_sees_the_last_value_of_the_other() -> None:
    class Seen(list[tuple[float, float]]):
        def __deepcopy__(self, memo: object) -> "Seen":
            return self  # one for all runs

    seen = Seen()

    def control(time: float, y: float) -> float:
        seen.append((time, y))
        return time

    plant = MockFmu()
    rows = run(loop(control, record_ns=MS), {"plant": plant})
    ys, us = rows["plant.y"].tolist(), rows["plant.u"].tolist()
    assert rows.times.tolist() == [t * MS for t in range(141)]
    assert seen == [(7 * k / 1000, ys[7 * k // 10 * 10]) for k in range(21)]
    assert us[10] == 0.007 and us[19] == 0.007 and us[20] == 0.014, "applied as the plant steps"
    assert plant.instances[0].model.steps == [(10 * k / 1000, 0.01) for k in range(14)]


def test_the_row_at_a_stop_time_off_the_controllers_grid() -> None:
    rows = run(loop(lambda time, y: time, stop_ns=100 * MS, record_ns=20 * MS),
               {"plant": MockFmu()})  # fmt: skip
    assert rows.times.tolist() == [t * MS for t in (0, 20, 40, 60, 80, 100)]
    assert rows["controller.u"].tolist() == [0.0, 0.014, 0.035, 0.056, 0.077, 0.098]


def test_one_note_names_both() -> None:
    plan = plan_system(loop(lambda time, y: y), {"plant": MockFmu()})  # type: ignore[arg-type]
    (note,) = plan.notes
    assert note.startswith("controller runs every 7 ms and plant steps by 10 ms")
    both = system(fmu("a"), fmu("b", 7 * MS), wire("a.y", "b.u"), wire("b.y", "a.u"),
                  stop_ns=140 * MS)  # fmt: skip
    plan = plan_system(both, {"a": MockFmu(), "b": MockFmu()})  # type: ignore[arg-type]
    (note,) = plan.notes
    assert note.startswith("b runs every 7 ms and a steps by 10 ms")
