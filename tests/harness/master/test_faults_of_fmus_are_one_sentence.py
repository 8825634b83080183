"""Whatever an FMU reports ends the run in one sentence: component, call, time, reason."""

import re

import pytest

from harness.errors import SimulationError
from harness.fmi.binding.logger import STATUS_NAMES
from tests.harness.master.mock import Input, MockFmu, MockInstance, Output
from tests.harness.master.rows import run_to_end
from tests.harness.master.small_systems import controller, fmu, system, wire

CALLS = {2: ("SetReal", "GetReal", "DoStep"), 3: ("SetFloat64", "GetFloat64", "DoStep")}
WORDS = {"S": "setting u", "G": "getting y", "D": "doStep by 10 ms"}


def plant(major: int) -> MockFmu:
    kind = "Real" if major == 2 else "Float64"
    return MockFmu((Input("u", kind),), (Output("y", kind),), major)


def loop() -> object:
    return system(
        fmu(), fmu("other"), controller(lambda time, y: y), wire("plant.y", "controller.y"),
        wire("controller.u", "plant.u"),
    )  # fmt: skip


def fail_at(name: str, count: int, status: int):  # type: ignore[no-untyped-def]
    """A hook that lets call number `count` of C function `name` of the plant return `status`."""

    def hook(instance: MockInstance, called: str) -> None:
        if instance.name == "plant" and instance.calls.count(name) == count:
            instance.statuses[name] = status

    return hook


@pytest.mark.parametrize("status", [2, 3, 4, 5, 17])
@pytest.mark.parametrize(("major", "name"), [(m, name) for m in (2, 3) for name in CALLS[m]])
def test_each_status_of_each_call(major: int, name: str, status: int) -> None:
    bad, other = plant(major), plant(major)
    count = {"D": 4, "G": 5, "S": 5}[name[0]]  # values are read and written once more to initialise
    bad.hook = fail_at(name, count, status)
    rows, outcome = run_to_end(loop(), {"plant": bad, "other": other})  # type: ignore[arg-type]
    assert isinstance(outcome.fault, SimulationError)
    label = STATUS_NAMES[status] if status < 6 else "status 17"
    expected = (
        f"component plant: {WORDS[name[0]]} at t = 0.03 s returned {label}: {name} said {status}"
    )
    assert str(outcome.fault) == expected
    assert rows.times[-1] == (20_000_000 if name[0] == "G" else 30_000_000)
    assert outcome.end_ns == 30_000_000


@pytest.mark.parametrize("major", [2, 3])
def test_after_fatal_nothing_is_called_not_even_free(major: int) -> None:
    bad = plant(major)
    bad.hook = fail_at("DoStep", 2, 4)
    other = plant(major)
    run_to_end(loop(), {"plant": bad, "other": other})  # type: ignore[arg-type]
    assert bad.instances[0].calls[-1] == "DoStep"
    assert other.instances[0].calls[-1] == "Free"


def test_after_error_the_instance_is_freed_and_not_terminated() -> None:
    bad = plant(2)
    bad.hook = fail_at("DoStep", 2, 3)
    run_to_end(loop(), {"plant": bad, "other": plant(2)})  # type: ignore[arg-type]
    assert bad.instances[0].calls[-1] == "Free"
    assert "Terminate" not in bad.instances[0].calls


def test_a_warning_goes_on() -> None:
    warned = plant(2)
    warned.statuses = {"DoStep": 1, "GetReal": 1, "SetReal": 1}
    rows, outcome = run_to_end(loop(), {"plant": warned, "other": plant(2)})  # type: ignore[arg-type]
    assert outcome.fault is None and len(rows.times) == 11
    assert warned.instances[0].calls[-2:] == ["Terminate", "Free"]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_an_output_that_is_no_number_is_named_with_its_time(value: float) -> None:
    bad = plant(3)

    def hook(instance: MockInstance, called: str) -> None:
        if len(instance.model.steps) == 4:
            instance.model.state = value

    bad.hook = hook
    rows, outcome = run_to_end(loop(), {"plant": bad, "other": plant(3)})  # type: ignore[arg-type]
    assert re.fullmatch(
        rf"output plant\.y is {value} at t = 0\.04 s; the rows before it are kept",
        str(outcome.fault),
    )
    assert rows.times[-1] == 30_000_000


def test_an_early_return_is_a_fault() -> None:
    bad = plant(3)
    bad.flags = lambda time: (0, 0, int(time == 0.05))
    _, outcome = run_to_end(loop(), {"plant": bad, "other": plant(3)})  # type: ignore[arg-type]
    assert "doStep by 10 ms at t = 0.05 s returned before the end" in str(outcome.fault)


def test_events_that_nobody_asked_for_are_the_fmus_own() -> None:
    eventful = plant(3)
    eventful.flags = lambda time: (1, 0, 0)
    _, outcome = run_to_end(loop(), {"plant": eventful, "other": plant(3)})  # type: ignore[arg-type]
    assert outcome.fault is None


def test_a_discarded_step_may_be_the_wish_to_end_of_fmi_2() -> None:
    done = plant(2)

    def hook(instance: MockInstance, called: str) -> None:
        instance.ended = len(instance.model.steps) == 6
        instance.statuses["DoStep"] = 2 if instance.ended else 0

    done.hook = hook
    _, outcome = run_to_end(loop(), {"plant": done, "other": plant(2)})  # type: ignore[arg-type]
    assert "asked for the end of the run in the step at t = 0.05 s" in str(outcome.fault)
    assert done.instances[0].calls[-2:] == ["Terminate", "Free"]


def test_the_wish_to_end_ends_the_run_as_incomplete_and_terminates() -> None:
    done = plant(3)
    done.flags = lambda time: (0, int(time == 0.05), 0)
    rows, outcome = run_to_end(loop(), {"plant": done, "other": plant(3)})  # type: ignore[arg-type]
    assert "component plant: the FMU asked for the end of the run" in str(outcome.fault)
    assert "t = 0.05 s" in str(outcome.fault)
    assert rows.times[-1] == 50_000_000
    assert done.instances[0].calls[-2:] == ["Terminate", "Free"]


def test_the_time_is_right_where_ticks_are_no_nanoseconds() -> None:
    bad = plant(3)
    bad.hook = fail_at("DoStep", 2, 3)
    ticks = {"ticks_per_second": 3 * 10**9, "record_ns": 10**9, "start_ns": 3 * 10**9}
    slow = system(fmu(step_ns=10**9), stop_ns=6 * 10**9, single=True, **ticks)
    _, outcome = run_to_end(slow, {"plant": bad})
    assert " at t = 1.33333333 s returned Error" in str(outcome.fault)


def test_a_fault_in_initialisation_bears_the_start_time() -> None:
    bad = plant(3)
    bad.statuses["GetFloat64"] = 3
    late = system(fmu(), wire("plant.y", "plant.u"), start_ns=20_000_000)
    _, outcome = run_to_end(late, {"plant": bad})
    assert " at t = 0.02 s returned Error" in str(outcome.fault)
    assert outcome.end_ns == 20_000_000
