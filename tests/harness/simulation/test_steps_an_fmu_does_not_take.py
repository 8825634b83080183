"""Steps of one size only, discarded steps, steps that end early without leave."""

from pathlib import Path

import pytest

from harness import simulate
from harness.errors import FmuError, SimulationError
from harness.fmi.binding.fmi2 import Fmi2Instance
from harness.fmi.binding.instance import StepOutcome
from tests.harness.fmi.archives import member, rewritten
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
IN_PYTHON = {"i_in": ([0.0, 9.0], [0, 1])}
"""An input over time, for which Python takes every step."""


def fixed_step_fmu(folder: Path) -> Path:
    source = model_fmu("2")
    xml = member(source, "modelDescription.xml")
    word = b'canHandleVariableCommunicationStepSize="'
    changed = xml.replace(word + b"true", word + b"false")
    assert changed != xml
    return rewritten(source, folder / "fixed.fmu", modelDescription_dot_xml=changed)


def test_no_step_passes_the_stop_time_and_none_is_shortened(tmp_path: Path) -> None:
    result = simulate(fixed_step_fmu(tmp_path), stop_time=1.0, step_size=0.3)
    assert list(result.time) == [0.0, 0.3, 0.6, 0.9]
    assert any("the run ends at t = 0.9 s: the FMU takes no steps but" in n for n in result.notes)


def test_a_jump_between_its_steps_acts_at_the_next_one(tmp_path: Path) -> None:
    result = simulate(fixed_step_fmu(tmp_path), stop_time=1.0, step_size=0.25,
                      inputs={"i_in": ([0.0, 0.3], [0, 1])})  # fmt: skip
    assert list(result.time) == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert list(result["i_out"]) == [0, 0, 0, 1, 1]


def test_where_steps_may_vary_the_last_one_is_shorter() -> None:
    result = simulate(model_fmu("2"), stop_time=1.0, step_size=0.3)
    assert list(result.time) == [0.0, 0.3, 0.6, 0.9, 1.0]


def test_a_discarded_step_ends_the_run_with_how_far_it_came(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given_up = StepOutcome(0.07, discarded=True)
    monkeypatch.setattr(Fmi2Instance, "advance", lambda *_: given_up)
    words = r"t = 0\.07 s was discarded \(computed up to 0\.07 s\)"
    with pytest.raises(SimulationError, match=words):
        simulate(model_fmu("2"), stop_time=1.0, step_size=0.1, inputs=IN_PYTHON)


def test_a_step_that_ends_early_without_leave_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Fmi2Instance, "advance", lambda *_: StepOutcome(0.05))
    with pytest.raises(FmuError, match=r"ended at 0\.05 s, though no early return was allowed"):
        simulate(model_fmu("2"), stop_time=1.0, step_size=0.1, inputs=IN_PYTHON)


def test_rows_may_be_rarer_than_steps() -> None:
    result = simulate(model_fmu("2"), stop_time=1.0, step_size=0.1, output_interval=0.5)
    assert list(result.time) == [0.0, 0.5, 1.0]
