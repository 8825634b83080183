"""Calls that return at once and never bring the run on end it, as one that does not return does."""

import re
from pathlib import Path

import pytest

from harness import simulate
from harness.errors import HarnessError
from harness.process.limits import Limits
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu

TIMES = {"stop_time": 0.1, "step_size": 0.01}


def test_a_step_that_is_pending_for_ever_is_one_call(tmp_path: Path) -> None:
    path = hostile_fmu(tmp_path, "DoStep pending 5", "GetStatus pending", fmi=2)
    words = r"fmi2GetStatus \(the step is pending\) at t = 0\.05 s had not returned after 0\.5 s"
    with pytest.raises(HarnessError, match=words) as caught:
        simulate(path, **TIMES, limits=Limits(call=0.5))
    assert len(caught.value.result.time) == 6


def test_a_step_that_is_pending_for_a_while_is_waited_for(tmp_path: Path) -> None:
    path = hostile_fmu(tmp_path, "DoStep pending 5", fmi=2)
    assert len(simulate(path, **TIMES).time) == 11


@pytest.mark.parametrize(
    ("action", "words"),
    [
        ("early_still", "more than 1000 events at t = 0.05 s, one after the other"),
        ("early_backwards", "ended at 0.04 s, as the FMU says, which is not within the step"),
        ("early_last_nan", "ended at nan s, as the FMU says, which is not within the step"),
    ],
)
def test_steps_that_end_early_without_going_on(tmp_path: Path, action: str, words: str) -> None:
    source = hostile_fmu(tmp_path, f"DoStep {action} 5")
    events = description(3).replace("<CoSimulation ", '<CoSimulation hasEventMode="true" ')
    path = rewritten(source, tmp_path / "x.fmu", modelDescription_dot_xml=events.encode())
    with pytest.raises(HarnessError, match=re.escape(words)):
        simulate(path, **TIMES, limits=Limits(call=5.0, run=20.0))
