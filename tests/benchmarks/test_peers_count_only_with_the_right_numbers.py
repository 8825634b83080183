"""A peer's time counts only if its numbers are those of the equations, which are also ours."""

import numpy as np
import pytest

from benchmarks.peers.environments import PEERS, Environment
from benchmarks.peers.loop import disagreement, expected, measured_rows
from benchmarks.peers.task import EARLY, Answer, RowsTask, read_answer
from benchmarks.pi import STEP, PlainPI


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_the_equations_are_those_of_the_benchmark(delay: int) -> None:
    controller, y, held = PlainPI(), 0.0, [0.0] * delay
    for k in range(EARLY):
        held.append(controller.step(k * STEP, y))
        y += STEP * (held.pop(0) - y)
    assert expected(EARLY, delay) == y
    assert abs(expected(EARLY, 0) - expected(EARLY, 1)) > 1e-4


def test_a_wrong_delay_is_seen_in_the_transient() -> None:
    early, last = expected(EARLY, 1), expected(10_000, 1)
    assert disagreement(Answer(early, last, 1.0), 10_000, 1, 1e-12) == ""
    words = disagreement(Answer(early, last, 1.0), 10_000, 0, 1e-12)
    assert words.startswith(f"y is {early:.9g} after {EARLY} steps, not ")
    assert "after 10000 steps" in disagreement(Answer(early, last + 1e-9, 1.0), 10_000, 1, 1e-12)


def test_an_answer_is_found_among_a_tool_s_own_lines() -> None:
    assert read_answer("hello\nanswer: [1.0, 2.0, 3.0]\nbye\n") == [1.0, 2.0, 3.0]
    assert read_answer("Segmentation fault") == []


def test_rows_that_differ_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks.frame import RefusedError
    from benchmarks.peers import loop

    monkeypatch.setattr(loop, "answered", lambda name, task: [[[1.0], [2.0]], 5.0])
    task = RowsTask({}, [[0.0], [1.0]])
    assert measured_rows("simpful", task, np.array([[1.0], [2.0]])) == 5.0
    with pytest.raises(RefusedError, match=r"differ from ours by 1.0e-06"):
        measured_rows("simpful", task, np.array([[1.0], [2.000001]]))


def test_a_peer_that_is_not_there_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks.peers import environments

    monkeypatch.setenv("XDG_CACHE_HOME", "/nowhere")
    found = {name: environments.installed(name) for name in PEERS}
    assert found["ecos"] == Environment(
        refusal="not installed: python -m benchmarks.peers install ecos"
    )
    assert environments.titled("ecos") == "ecospy"
