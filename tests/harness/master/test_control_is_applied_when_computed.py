"""u computed at k is applied at k: y_k read, u_k computed from it, applied, then the step."""

import numpy as np

from tests.harness.master.mock import MockFmu
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire


def proportional(time: float, y: float) -> float:
    return 2.0 - 0.5 * y


def test_the_closed_loop_is_the_textbook_recursion() -> None:
    plant = MockFmu(state=1.0)
    rows = run(
        system(fmu(), controller(proportional), wire("plant.y", "controller.y"),
               wire("controller.u", "plant.u")),
        {"plant": plant},
    )  # fmt: skip
    s, y, u = 1.0, [], []
    for k in range(11):
        y.append(s)
        u.append(proportional(0.0, s))
        s = 0.9 * s + 0.01 * u[k] + (k * 10 / 1000) / 64
    assert rows["plant.y"].tolist() == y
    assert rows["controller.u"].tolist() == u
    assert rows["plant.u"].tolist() == u, "what is applied is what is computed, in the same row"
    assert rows["controller.y"].tolist() == y, "what is measured is what is read, in the same row"


def test_control_is_held_between_samples() -> None:
    rows = run(
        system(fmu(step_ns=5 * MS), controller(lambda time, y: 100 * time, 20 * MS),
               wire("plant.y", "controller.y"), wire("controller.u", "plant.u"), record_ns=5 * MS),
        {"plant": MockFmu()},
    )  # fmt: skip
    expected = [2.0 * (k // 4) for k in range(21)]
    assert np.array_equal(rows["plant.u"], expected)


def test_a_faster_controller_sees_the_plant_held() -> None:
    rows = run(
        system(fmu(), controller(lambda time, y: y, 5 * MS), wire("plant.y", "controller.y"),
               wire("controller.u", "plant.u"), record_ns=5 * MS),
        {"plant": MockFmu()},
    )  # fmt: skip
    y = rows["controller.y"]
    assert np.array_equal(y[0:-1:2], y[1::2]), "between two steps the plant's output is held"
    assert len(set(y[::2])) == 11
