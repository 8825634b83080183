"""What another tool is asked to do with one FMU, and its answer, both as JSON.

A tool runs in a process of its own: it is native code of others, and so are our FMUs to it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).parents[2]
TOLERANCE = 1e-8
_MARK = "answer: "


class RefusedError(Exception):
    """A tool did not do what it was asked to; what it said."""


@dataclass(frozen=True)
class Order:
    """Step the FMUs (`fmus`: path by component name), or those of the `package` (an .ssp), together
    by `step` (s) from 0.

    `wires` are pairs of ports "component.variable", from an output to an input. Row k of the
    columns `inputs` is set before step k; `outputs` are reported after each step; `start_values`
    are set before initialisation; a package says all three itself. All variables are real numbers.
    `program` is the path of a tool that is one; `interface` is "co-simulation", or
    "model-exchange", which the tool's own solver integrates to a relative tolerance of `TOLERANCE`.
    """

    fmus: dict[str, str]
    step: float
    steps: int
    outputs: list[str]
    inputs: dict[str, list[float]] = field(default_factory=dict)
    wires: list[tuple[str, str]] = field(default_factory=list)
    start_values: dict[str, float] = field(default_factory=dict)
    package: str = ""
    program: str = ""
    interface: str = "co-simulation"

    def rows(self) -> Iterator[list[float]]:
        """What is set before each step, in the order of `inputs`."""
        return ([column[k] for column in self.inputs.values()] for k in range(self.steps))


def read_order() -> Order:
    """The order on standard input."""
    return Order(**json.load(sys.stdin))


def answer(rows: list[list[float]]) -> None:
    """Rows of the outputs, one after each step, as a line of standard output among the tool's."""
    print("\n" + _MARK + json.dumps(rows), flush=True)


def run_in(tool: str, order: Order) -> NDArray[np.float64]:
    """The rows that `tests/peers/<tool>_driver.py` answers, shape (steps, outputs).

    Raises `RefusedError`. Shared libraries are searched in the environment, too, where PyPI's `tbb`
    puts the one that Ecos and libcosim are linked with.
    """
    libraries = [str(Path(sys.prefix, "lib")), os.environ.get("LD_LIBRARY_PATH", "")]
    done = subprocess.run(
        [sys.executable, "-m", f"tests.peers.{tool}_driver"],
        input=json.dumps(asdict(order)),
        cwd=ROOT,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path]),
            "LD_LIBRARY_PATH": os.pathsep.join(filter(None, libraries)),
        },
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    if done.returncode != 0:
        raise RefusedError(done.stderr[-2000:].strip() or f"{tool} ended with {done.returncode}")
    lines = [line for line in done.stdout.splitlines() if line.startswith(_MARK)]
    return np.array(json.loads(lines[-1].removeprefix(_MARK)))
