"""What the benchmarks of other people's FMUs and packages share: sides in processes of their own,
the difference of two trajectories, tables."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
"""Trajectories by name, "time" (s) among them."""
AGREES = 1e-3
"""The difference, as a share of a variable's range, up to which two sides agree: both solvers of
model exchange keep a relative tolerance of 1e-5 a step, and may see an event a step apart."""


@dataclass(frozen=True)
class Answer:
    """What one side did: `words` is its refusal or fault, empty where it ran; `seconds` of the
    simulation alone."""

    words: str = ""
    seconds: float = 0.0
    columns: Columns = field(default_factory=dict)

    @property
    def ran(self) -> bool:
        """Whether there is a trajectory."""
        return not self.words


def ask(side: str, task: Mapping[str, Any], seconds: float) -> Answer:
    """Run `benchmarks.foreign_side.{side}(**task)` in a process of its own within `seconds`."""
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.npz"
        command = [sys.executable, "-m", "benchmarks.foreign_side", side, json.dumps(task)]
        said = Path(folder) / "said.txt"
        with said.open("wb") as stream:
            process = subprocess.Popen(
                [*command, str(answer)], stdout=stream, stderr=stream, stdin=subprocess.DEVNULL,
                start_new_session=True, cwd=Path(__file__).parent.parent,
            )  # fmt: skip
            begun = time.monotonic()
            try:
                code = process.wait(seconds)
            except subprocess.TimeoutExpired:
                return Answer(f"did not end within {seconds:g} s", time.monotonic() - begun)
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        if not answer.is_file():
            last = said.read_text(errors="replace").strip().splitlines()[-1:]
            return Answer(f"its process ended with code {code}: {''.join(last)}")
        with np.load(answer) as data:
            told = json.loads(str(data["told"]))
            columns = {name: data[f"column{i}"] for i, name in enumerate(told["names"])}
        return Answer(told["words"], told["seconds"], columns)


def difference(ours: Columns, theirs: Columns) -> tuple[float, str]:
    """The largest difference at equal times as a share of the variable's range (of its size where
    it is constant), and the variable; the last row counts where a time repeats.

    What lies between the values of the other side a row before and a row after is no difference:
    solvers see an event a step apart, and FMUs that add up their own steps end one of them earlier
    or later. Infinity where no time is common or where one side alone is finite.
    """
    rows, others = _last_rows(ours["time"]), _last_rows(theirs["time"])
    common = sorted(rows.keys() & others.keys())
    if not common:
        return float("inf"), "time"
    here, there = [rows[t] for t in common], [others[t] for t in common]
    worst = (0.0, "")
    for name in (name for name in ours if name != "time" and name in theirs):
        worst = max(worst, (_share(ours[name][here], theirs[name][there]), name))
    return worst


def _last_rows(times: Array) -> dict[float, int]:
    return {float(f"{t:.9g}"): row for row, t in enumerate(times)}


def _share(ours: Array, theirs: Array) -> float:
    if not np.array_equal(np.isfinite(theirs), np.isfinite(ours)):
        return float("inf")
    ours, theirs = np.nan_to_num(ours), np.nan_to_num(theirs)
    beside = np.stack([np.r_[theirs[:1], theirs[:-1]], theirs, np.r_[theirs[1:], theirs[-1:]]])
    outside = np.maximum(beside.min(0) - ours, ours - beside.max(0))
    spread = max(float(np.ptp(theirs)), 1e-6 * float(np.abs(theirs).max())) or 1.0
    return max(0.0, float(outside.max())) / spread


def markdown(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A table."""
    cells = [head, ["---"] * len(head), *lines]
    return "".join(
        "| " + " | ".join(" ".join(c.replace("|", "\\|").split()) for c in line) + " |\n"
        for line in cells
    )


def write_rows(path: Path | None, rows: Sequence[Mapping[str, Any]]) -> None:
    """The rows as JSON, where a path was given."""
    if path is not None:
        path.write_text(json.dumps(rows, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
