"""A run that the FMU ends, gives up or breaks off: one sentence, and the rows before it."""

import os
from itertools import pairwise
from pathlib import Path

import pytest

from harness import simulate
from harness.errors import FmuError, SimulationError, UsageError
from harness.fmi.binding.fmi3 import Fmi3Instance
from tests.harness.fmi.archives import member, rewritten
from tests.harness.simulation.fmus import misbehaving_fmu, model_fmu, needs_compiler

pytestmark = needs_compiler


@pytest.mark.parametrize(
    ("kind", "interface"),
    [("2", "co-simulation"), ("2", "model-exchange"), ("3", "co-simulation"),
     ("3", "model-exchange"), ("1-model", None)],
)  # fmt: skip
def test_an_fmu_may_end_the_simulation(kind: str, interface: str | None) -> None:
    result = simulate(
        model_fmu(kind), interface_type=interface, stop_time=2.0, output_interval=0.25,
        start_values={"end": 0.75},
    )  # fmt: skip
    assert result.status.state == "complete" and result.time[-1] == pytest.approx(0.75, abs=1e-9)
    assert "the FMU asked to end the simulation at t = 0.75 s" in result.notes


def test_a_status_of_fmi_1_is_a_sentence() -> None:
    with pytest.raises(FmuError) as caught:
        simulate(model_fmu("1-slave"), stop_time=1.0, step_size=0.1, start_values={"end": 0.45})
    assert str(caught.value) == (
        "component test: test_fmiDoStep at t = 0.4 s returned Error: no step beyond 0.45 s"
    )
    assert list(caught.value.result.time) == [0.0, 0.1, 0.2, 0.3, 0.4]


@pytest.mark.parametrize("kind", ["1-slave", "1-model", "2"])
def test_the_reason_of_a_refused_instantiation_is_told(tmp_path: Path, kind: str) -> None:
    source = model_fmu(kind)
    xml = member(source, "modelDescription.xml").replace(b'guid="{', b'guid="{other')
    made = rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=xml)
    with pytest.raises(FmuError, match=r"could not be instantiated: the guid {other.} is not mine"):
        simulate(made)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"interface_type": "scheduled"}, "interface type 'scheduled' is unknown; choose"),
        ({"stop_time": -1.0}, "stop time -1 s lies before the start time 0 s"),
        ({"step_size": 0.0}, "step size must be positive, not 0.0"),
        ({"relative_tolerance": -1.0}, "relative tolerance must be positive"),
        ({"stop_time": float("inf")}, "stop time must be finite"),
        ({"output_variables": ["z*"]}, r"nothing to record matches 'z\*'"),
        ({"solver": "magic"}, "solver 'magic' is unknown; choose cvode or euler"),
    ],
)
def test_options_that_cannot_be_meant(options: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        simulate(model_fmu("2"), **options)  # type: ignore[arg-type]


def test_an_interface_that_is_not_offered_names_what_is(tmp_path: Path) -> None:
    with pytest.raises(FmuError, match="offers no model-exchange; it offers co-simulation"):
        simulate(model_fmu("1-slave"), interface_type="ME")
    source = model_fmu("3")
    xml = member(source, "modelDescription.xml")
    head, _, rest = xml.partition(b"<ModelExchange")
    body = rest[rest.index(b"<UnitDefinitions") :]
    scheduled = head + b'<ScheduledExecution modelIdentifier="test"/>' + body
    made = rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=scheduled)
    with pytest.raises(FmuError, match=r"offers no co-simulation; it offers scheduled-execution$"):
        simulate(made, interface_type="CS")


def test_a_time_event_that_stays_in_the_past_ends_with_a_sentence() -> None:
    stuck = misbehaving_fmu("i->next = 0.1", "TELL")
    with pytest.raises(SimulationError, match=r"more than 1000 events at t = 0\.1 s") as caught:
        simulate(stuck, interface_type="me", stop_time=1.0, output_interval=0.05)
    assert list(caught.value.result.time[:3]) == [0.0, 0.05, 0.1]


def test_an_event_that_does_not_settle_ends_with_a_sentence() -> None:
    restless = misbehaving_fmu("i->update = 1", "TELL")
    with pytest.raises(SimulationError, match="event at t = 0 s does not settle in 1000"):
        simulate(restless, interface_type="me", stop_time=1.0)


def test_a_step_event_is_handled_where_the_fmu_asks_for_it() -> None:
    asking = misbehaving_fmu(
        "*event = p->completed == 3, *terminate = p->completed == 6", "STEPPED"
    )
    result = simulate(
        asking, interface_type="me", stop_time=1.0, output_interval=0.5,
        output_variables=["completed"],
    )  # fmt: skip
    gaps = [b - a for a, b in pairwise(result.time)]
    assert gaps.count(0.0) == 1  # both sides of one event, then the end
    at = gaps.index(0.0)
    assert list(result["completed"][at : at + 2]) == [3, 3] and result["completed"][-1] == 6
    assert result.time[-1] < 0.5 and "asked to end" in result.notes[0]


def test_the_working_directory_is_never_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "chdir", None)
    simulate(model_fmu("1-slave"), stop_time=0.1)
    simulate(model_fmu("3"), interface_type="me", stop_time=0.1)
    assert Path.cwd() == tmp_path and list(tmp_path.iterdir()) == []


def test_an_event_mode_that_is_claimed_and_refused_is_done_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    real = Fmi3Instance._instantiate

    def refusing(instance: Fmi3Instance, folder: Path, logging: bool) -> int | None:
        return None if instance.event_mode else real(instance, folder, logging)

    monkeypatch.setattr(Fmi3Instance, "_instantiate", refusing)
    result = simulate(model_fmu("3"), stop_time=0.1, step_size=0.1, output_variables=["x"])
    assert list(result.time) == [0.0, 0.1] and "without event mode, since" in result.notes[0]
    with pytest.raises(FmuError, match="could not be instantiated"):
        simulate(model_fmu("3"), event_mode=True)
