"""A step that an FMU discards is taken in smaller ones where it can go back or says how far it
came: the trajectory is the exact one and rows are where they were asked for."""

from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.errors import SimulationError
from tests.hostile.build import hostile_fmu

TIMES = {"stop_time": 0.1, "step_size": 0.01, "start_values": {"u": 1.0}}


def exact(time: np.ndarray) -> np.ndarray:
    return 1.0 - np.exp(-time / 0.1)


@pytest.mark.parametrize(
    ("fmi", "behaviour", "states"),
    [(2, "too_long 0 3000", True), (3, "too_long 3 3000", True), (3, "too_long 0 50", True),
     (2, "halfway", False)],
)  # fmt: skip
def test_smaller_steps_give_the_same_trajectory(
    tmp_path: Path, fmi: int, behaviour: str, states: bool
) -> None:
    path = hostile_fmu(tmp_path, f"DoStep {behaviour}", fmi=fmi, states=states)
    result = simulate(path, **TIMES)
    assert np.allclose(result.time, np.arange(11) / 100, rtol=0, atol=1e-15)
    assert np.allclose(result["y"], exact(result.time), rtol=0, atol=1e-12)
    notes = [note for note in result.notes if "smaller ones were taken instead" in note]
    first = 0.03 if " 3 " in behaviour else 0.0
    assert len(notes) == 1 and f"from t = {first:g} s on" in notes[0]


def test_who_takes_no_step_at_all_is_left_with_its_rows(tmp_path: Path) -> None:
    path = hostile_fmu(tmp_path, "DoStep discard 5", "DoStep log 5")
    words = r"t = 0\.05 s was discarded.*the valve sticks; so were 20 smaller ones"
    with pytest.raises(SimulationError, match=words) as caught:
        simulate(path, **TIMES)
    assert len(caught.value.result.time) == 6


@pytest.mark.parametrize("fmi", [2, 3])
def test_who_cannot_go_back_is_not_asked_again(tmp_path: Path, fmi: int) -> None:
    path = hostile_fmu(tmp_path, "DoStep too_long 5 3000", fmi=fmi, states=False)
    with pytest.raises(SimulationError, match="cannot go back, so try a smaller --step-size"):
        simulate(path, **TIMES)


def test_a_false_promise_of_snapshots_stops_nobody(tmp_path: Path) -> None:
    path = hostile_fmu(tmp_path, "GetFMUState error 4")
    result = simulate(path, **TIMES)
    assert len(result.time) == 11
    assert any("cannot be repeated, since: component hostile" in note for note in result.notes)
