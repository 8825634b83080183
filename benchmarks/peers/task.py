"""What a peer is asked to do, and its answer, both as JSON; no package beyond the standard library.

The loop: at t_k = k·step a PI controller computes u_k from the plant's y_k, and the plant, a
first-order lag, steps with u_(k-delay). What the tool takes to load, to link and to initialise does
not count.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

EARLY = 150
"""Steps of the run that is compared in the middle of its transient."""
_MARK = "answer: "


@dataclass(frozen=True)
class Task:
    """Paths of the FMUs, plant (u to y) and controller (y to u); step (s), number of steps, and the
    parameters of the controller, for tools in which it is written in Python."""

    plant: str
    controller: str
    step: float
    steps: int
    reference: float
    kp: float
    ki: float

    def python_controller(self) -> Callable[[float], float]:
        """The PI controller at rest, from y to u."""
        integral = 0.0

        def compute(y: float) -> float:
            nonlocal integral
            error = self.reference - y
            integral += self.ki * error
            return self.kp * error + integral

        return compute


@dataclass(frozen=True)
class Answer:
    """y after `EARLY` and after all steps; nanoseconds of processor time a step, all threads."""

    early: float
    last: float
    nanoseconds: float


@dataclass(frozen=True)
class RowsTask:
    """Numbers of a `model`, and `rows` of inputs, of each of which the outputs are wanted."""

    model: dict[str, Any]
    rows: list[list[float]]


@dataclass(frozen=True)
class RowsAnswer:
    """The outputs of each row; nanoseconds of processor time a row."""

    outputs: list[list[float]]
    nanoseconds: float


Run = Callable[[], float]
"""Does all steps and gives the plant's y after the last."""


OfRow = Callable[[list[float]], list[float]]
"""From the inputs of a row to its outputs."""


def carry_out_rows(prepare: Callable[[dict[str, Any]], OfRow]) -> None:
    """The same for rows, by the function of a row that `prepare` makes of the model."""
    task = RowsTask(**json.load(sys.stdin))
    function = prepare(task.model)
    function(task.rows[0])
    function = prepare(task.model)
    began = time.process_time()
    outputs = [function(row) for row in task.rows]
    nanoseconds = 1e9 * (time.process_time() - began) / len(task.rows)
    _answer(outputs, nanoseconds)


def carry_out(prepare: Callable[[Task, int], Run]) -> None:
    """Do what standard input asks for, by the `Run` that `prepare` makes of a number of steps."""
    task = Task(**json.load(sys.stdin))
    early = prepare(task, EARLY)()
    run = prepare(task, task.steps)
    began = time.process_time()
    last = run()
    nanoseconds = 1e9 * (time.process_time() - began) / task.steps
    _answer(early, last, nanoseconds)


def _answer(*values: Any) -> None:
    print("\n" + _MARK + json.dumps(values), flush=True)
    sys.stderr.flush()
    os._exit(0)  # native tools may end a process in their destructors


def read_answer(text: str) -> list[Any]:
    """What a driver answered, among the tool's own lines; empty where it gave no answer."""
    lines = [line for line in text.splitlines() if line.startswith(_MARK)]
    return list(json.loads(lines[-1].removeprefix(_MARK))) if lines else []
