"""µs per macro step of a closed loop: ours, bare C, FMPy. `python -m benchmarks.closed_loop`.

A trivial FMU (`c/`) under a PI controller, so that only the master's own cost is seen. All sides
run in turn, several rounds; every side must end at the y and u of the C program, bit for bit, or
the benchmark fails (simulate_fmu, whose steps are differences of rounded times: to 1e-12).
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import fmpy
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from benchmarks import sides
from benchmarks.lag import Lag, build_lag
from benchmarks.measuring import Series, interleaved, machine, write_json
from benchmarks.sides import Measured

C, C_NO_ROWS = "bare C program", "bare C program, no rows"
OURS, OURS_NO_ROWS = "ours, compiled controller", "ours, compiled controller, no columns"
CONTROLLER, OURS_PYTHON = "Python controller in a bare Python loop", "ours, Python controller"
LOW, METHODS = "FMPy low level, preallocated arrays", "FMPy low level, its methods"
SIMULATE = "FMPy simulate_fmu, step_finished"

BASELINE = {OURS: C, OURS_NO_ROWS: C_NO_ROWS, OURS_PYTHON: CONTROLLER}
"""What a side is compared with, where it is not the bare C program."""

BOUND = {OURS: 25.0, OURS_NO_ROWS: 25.0, OURS_PYTHON: 600.0}
"""ns above the baseline: what the project promises."""


@dataclass(frozen=True)
class Side:
    """One way to run the loop: `run(steps)`, how many steps to measure, and how exact it is."""

    run: Callable[[int], Measured]
    steps: int
    tolerance: float = 0.0


def sides_of(lag: Lag, unpacked: Path, steps: int) -> dict[str, Side]:
    """All sides by name, in the order of the table; the slow ones run fewer steps."""
    some, few = steps // 10, steps // 100
    return {
        C: Side(partial(sides.bare_c, lag, True), steps),
        OURS: Side(partial(sides.compiled, lag, True), steps),
        C_NO_ROWS: Side(partial(sides.bare_c, lag, False), steps),
        OURS_NO_ROWS: Side(partial(sides.compiled, lag, False), steps),
        CONTROLLER: Side(sides.bare_python_controller, some),
        OURS_PYTHON: Side(partial(sides.plain_python, lag), some),
        LOW: Side(partial(sides.fmpy_low_level, lag, unpacked, True), few),
        METHODS: Side(partial(sides.fmpy_low_level, lag, unpacked, False), few),
        SIMULATE: Side(partial(sides.fmpy_simulate, lag, unpacked), few, 1e-12),
    }


def measure(folder: Path, fmi_version: int, steps: int, repeats: int) -> dict[str, Series]:
    """All sides for one FMI version, ns per macro step."""
    lag = build_lag(folder, fmi_version)
    unpacked = Path(fmpy.extract(str(lag.fmu), str(lag.fmu.with_suffix(""))))
    chosen = sides_of(lag, unpacked, steps)
    ends = {n: sides.bare_c(lag, False, n).last for n in {side.steps for side in chosen.values()}}

    def nanoseconds(name: str, side: Side) -> float:
        measured = side.run(side.steps)
        for value, expected in zip(measured.last or (), ends[side.steps] or (), strict=False):
            if not math.isclose(value, expected, rel_tol=side.tolerance, abs_tol=0.0):
                raise SystemExit(f"{name} ends at {measured.last}, not at {ends[side.steps]}")
        return measured.nanoseconds

    return interleaved({n: partial(nanoseconds, n, side) for n, side in chosen.items()}, repeats)


def difference(results: dict[str, Series], name: str, of: Callable[[Series], float]) -> float:
    """ns above the baseline of `name`."""
    return of(results[name]) - of(results[BASELINE.get(name, C)])


def table(fmi_version: int, results: dict[str, Series]) -> Table:
    """Medians and minima in µs, differences of the medians in ns."""
    made = Table(title=f"Closed loop, FMI {fmi_version}, per macro step", box=SIMPLE)
    made.add_column("", no_wrap=True)
    for heading in ("median µs", "min µs", "above, ns", "bound", "times C"):
        made.add_column(heading, justify="right", no_wrap=True)
    compared = {*BASELINE, LOW, METHODS, SIMULATE}
    for name, series in results.items():
        above = difference(results, name, lambda s: s.median)
        made.add_row(
            name,
            f"{series.median / 1e3:.4f}",
            f"{series.minimum / 1e3:.4f}",
            f"{above:.1f}" if name in compared else "",
            f"{BOUND[name]:g}" if name in BOUND else "",
            f"{series.median / results[C].median:.1f}",
        )
    return made


def report(results: dict[int, dict[str, Series]]) -> dict[str, Any]:
    """For the JSON file."""
    return {
        f"fmi{fmi_version}": {
            name: {"ns": s.as_json(), "above": difference(sides_, name, lambda s: s.median)}
            for name, s in sides_.items()
        }
        for fmi_version, sides_ in results.items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=2_000_000, help="macro steps (at least 10000)")
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--json", type=Path, help="write all measurements there")
    options = parser.parse_args()
    console = Console(width=100)
    console.print(*machine().values(), sep="\n")
    results = {}
    for fmi_version in (2, 3):
        with tempfile.TemporaryDirectory() as folder:
            results[fmi_version] = measure(
                Path(folder), fmi_version, options.steps, options.repeats
            )
        console.print(table(fmi_version, results[fmi_version]))
    if options.json:
        write_json(options.json, {"unit": "ns per macro step", **report(results)})
    broken = [
        f"FMI {version}: {name}"
        for version, sides_ in results.items()
        for name, bound in BOUND.items()
        if difference(sides_, name, lambda s: s.median) > bound
    ]
    if broken:
        raise SystemExit("above its bound: " + "; ".join(broken))


if __name__ == "__main__":
    main()
