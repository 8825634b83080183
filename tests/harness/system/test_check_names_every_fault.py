"""A system that does not fit together is refused before anything runs, with the way out."""

from dataclasses import replace
from typing import Any

import pytest

from harness.errors import GraphError
from harness.master.run import plan_system
from harness.system.block import Port
from harness.system.graph import PythonComponent, SensitivityComponent
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.small_systems import MS, controller, fmu, system, wire


def plant() -> MockFmu:
    return MockFmu(
        (Input("command", unit="N"), Input("label", "String"), Input("valve")),
        (Output("force", unit="N"), Output("position", unit="mm")),
    )


def judge(*parts: Any, record: tuple[str, ...] = ("*",), **more: Any) -> str:
    fmus = {"plant": plant()}
    with pytest.raises(GraphError) as caught:
        plan_system(system(fmu(), *parts, **more), fmus, record)  # type: ignore[arg-type]
    return str(caught.value)


def reader(name: str = "reader", unit: str = "") -> PythonComponent:
    ports = (Port("measured", unit),)
    return PythonComponent(name, lambda time, y: y, ports, (Port("u", unit),), 10 * MS)


GOOD = (reader(), wire("plant.force", "reader.measured"))


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (wire("plnt.force", "plant.command"), "no component 'plnt'; did you mean 'plant'?"),
        (wire("reader.u", "plan.command"), "no component 'plan'; did you mean 'plant'?"),
        (
            wire("plant.forse", "plant.command"),
            "plant has no output 'forse'; did you mean 'force'?",
        ),
        (wire("reader.u", "plant.comand"), "plant has no input 'comand'; did you mean 'command'?"),
        (wire("reader.y", "plant.command"), "reader has no output 'y'; legal names: u"),
        (wire("reader.u", "plant.force"), "plant has no input 'force'"),
        (wire("plant.command", "plant.valve"), "plant has no output 'command'"),
        (wire("plant.force", "plant.label"), "cannot be wired to String; numbers, booleans"),
        (wire("plant.position", "plant.command"), "'mm' (m) cannot be converted to 'N'"),
        (wire("reader.u", "plant.command", -5), "delay -5 ns is negative"),
    ],
)
def test_wires(bad: Any, words: str) -> None:
    text = judge(*GOOD, bad)
    assert words in text
    assert text.startswith(f"connection {bad.source} -> {bad.target}: ")


def test_all_faults_are_reported_at_once_a_line_each() -> None:
    text = judge(*GOOD, wire("x.y", "plant.command"), wire("reader.u", "plant.valv"))
    assert len(text.splitlines()) == 2


def test_double_wiring_names_both_sources() -> None:
    text = judge(*GOOD, wire("reader.u", "plant.valve"), wire("plant.force", "plant.valve"))
    assert "input plant.valve is connected 2 times: from reader.u and plant.force" in text


def test_unconnected_input_of_a_controller() -> None:
    assert judge(reader()) == (
        "input reader.measured is not connected; connect a signal to it, for instance a constant"
    )


def test_component_names_are_unique() -> None:
    assert "component name 'reader' is used 2 times" in judge(*GOOD, reader())


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"algorithm": "gauss"}, "no algorithm 'gauss'; did you mean 'gauss-seidel'?"),
        ({"stop_ns": 0}, "stop time 0 s is not after start time 0 s"),
    ],
)
def test_the_system_itself(change: dict[str, Any], words: str) -> None:
    assert words in judge(*GOOD, **change)


def test_start_values() -> None:
    bad = replace(fmu("second"), start_values={"comand": 1.0})
    parts = system(fmu(), bad)
    with pytest.raises(GraphError, match=r"second: no variable 'comand'.*did you mean 'command'"):
        plan_system(parts, {"plant": plant(), "second": plant()})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (("plnt", "force", "command"), "no FMU component 'plnt'; did you mean 'plant'?"),
        (("plant", "forc", "command"), "plant has no output 'forc'; did you mean 'force'?"),
        (("plant", "force", "comand"), "plant has no input 'comand'; did you mean 'command'?"),
        (("plant", "force", "command"), "provides no directional derivatives"),
    ],
)
def test_sensitivities(fields: tuple[str, str, str], words: str) -> None:
    assert words in judge(SensitivityComponent("slope", *fields, 10 * MS))


def test_an_fmu_without_co_simulation() -> None:
    only = plant()
    only.description = replace(only.description, co_simulation=None)
    with pytest.raises(
        GraphError, match=r"plant: FMU mock offers no co-simulation; it offers nothing"
    ):
        plan_system(system(fmu()), {"plant": only})  # type: ignore[arg-type]


def test_blocks_that_wait_for_each_other() -> None:
    first = controller(lambda time, y: y, name="first")
    second = controller(lambda time, y: y, name="second")
    wires = wire("first.u", "second.y"), wire("second.u", "first.y")
    text = judge(first, second, *wires)
    assert "wait for each other at the same instant" in text and "one sample" in text
    assert "first.u -> second.y" in text and "second.u -> first.y" in text
    delayed = system(first, second, wires[0], wire("second.u", "first.y", 10 * MS))
    plan_system(delayed, {})


def test_recording_what_is_not_there() -> None:
    text = judge(*GOOD, record=("plant.forc",))
    assert (
        text
        == "nothing to record matches 'plant.forc'; did you mean 'plant.force' or 'plant.position'?"
    )
