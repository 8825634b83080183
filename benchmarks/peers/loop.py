"""The closed loop in a peer: its driver in a process of its own, its numbers against the oracle."""

from __future__ import annotations

import json
import math
import subprocess
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.frame import RefusedError
from benchmarks.lag import Lag
from benchmarks.peers.environments import PEERS, installed, python, variables
from benchmarks.peers.task import EARLY, Answer, RowsAnswer, RowsTask, Task, read_answer
from benchmarks.pi import KI, KP, REFERENCE, STEP, pi_block
from harness.export.controller import controller_fmu

ROOT = Path(__file__).parents[2]
SECONDS = 300.0


def task_of(lag: Lag) -> Task:
    """The loop of the benchmark as FMUs (FMI 2) and numbers; steps are those of the peer."""
    controller = controller_fmu(pi_block(), "pi", STEP, 2)
    return Task(str(lag.fmu), str(controller), STEP, 0, REFERENCE, KP, KI)


@cache
def expected(steps: int, delay: int) -> float:
    """y after so many steps where u_(k-delay) acts in step k: the equations, in plain Python."""
    y, integral, waiting = 0.0, 0.0, [0.0] * delay
    for _ in range(steps):
        error = REFERENCE - y
        integral += KI * error
        waiting.append(KP * error + integral)
        y += STEP * (waiting.pop(0) - y)
    return y


def measured(name: str, task: Task) -> float:
    """Nanoseconds a step in the peer called so; raises `RefusedError`."""
    peer = PEERS[name]
    answer = Answer(*answered(name, replace(task, steps=peer.steps)))
    if words := disagreement(answer, peer.steps, peer.delay, peer.tolerance):
        raise RefusedError(words)
    return answer.nanoseconds


def measured_rows(name: str, task: RowsTask, right: NDArray[np.float64]) -> float:
    """The same for rows, whose outputs must be `right`, shape (rows, outputs), to 1e-9."""
    answer = RowsAnswer(*answered(name, task))
    gap = float(np.abs(np.array(answer.outputs) - right).max())
    if not gap <= 1e-9 * np.abs(right).max():
        raise RefusedError(f"its outputs differ from ours by {gap:.1e}")
    return answer.nanoseconds


def answered(name: str, task: Task | RowsTask) -> list[Any]:
    """What the driver of a peer answers; raises `RefusedError`."""
    if refusal := installed(name).refusal:
        raise RefusedError(refusal)
    command = [str(python(name)), "-m", f"benchmarks.peers.drivers.{name}"]
    try:
        done = subprocess.run(
            command, input=json.dumps(asdict(task)), cwd=ROOT, env=variables(name, ROOT),
            capture_output=True, text=True, check=False, timeout=SECONDS,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise RefusedError(f"did not end within {SECONDS:g} s") from None
    answer = read_answer(done.stdout)
    if not answer:
        said = done.stderr.strip().splitlines()
        raise RefusedError(said[-1] if said else f"ended with {done.returncode}")
    return answer


def disagreement(answer: Answer, steps: int, delay: int, tolerance: float) -> str:
    """What is wrong with the values in an answer, "" where they are those of the equations."""
    for count, value in ((EARLY, answer.early), (steps, answer.last)):
        right = expected(count, delay)
        if not math.isclose(value, right, rel_tol=tolerance, abs_tol=0.0):
            return f"y is {value:.9g} after {count} steps, not {right:.9g}"
    return ""
