"""Closed loops per macro step: ours, bare C, FMPy. `python -m benchmarks.closed_loop`.

A trivial FMU (`c/`) under a PI controller, so that only the master's own cost is seen; one of them,
and 4, 16, 64 side by side. All sides run in turn, several rounds, and ratios are taken round by
round; every side must end at the y and u of the C program, bit for bit, or the benchmark fails
(simulate_fmu, whose steps are differences of rounded times: to 1e-12).
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
from collections.abc import Callable, Sequence
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
OURS, OURS_NO_ROWS = "ours, compiled controller", "ours, compiled controller, a row in 1000"
CONTROLLER, OURS_PYTHON = "Python controller in a bare Python loop", "ours, Python controller"
LOW, METHODS = "FMPy low level, preallocated arrays", "FMPy low level, its methods"
SIMULATE = "FMPy simulate_fmu, step_finished"

BASELINE = {OURS: C, OURS_NO_ROWS: C_NO_ROWS, OURS_PYTHON: CONTROLLER}
"""What a side is compared with, where it is not the bare C program."""

BOUND = {OURS: 1.2, OURS_NO_ROWS: 1.2, OURS_PYTHON: 3.0}
"""What the project promises of the ratio to that, for one loop."""

LOOPS = (1, 4, 16, 64)


@dataclass(frozen=True)
class Side:
    """One way to run the loop: `run(steps)`, how many steps to measure, and how exact it is."""

    run: Callable[[int], Measured]
    steps: int
    tolerance: float = 0.0


def sides_of(lag: Lag, unpacked: Path, steps: int, loops: int = 1) -> dict[str, Side]:
    """All sides by name, in the order of the table; the slow ones run fewer steps, and FMPy's a
    single loop."""
    some, few = steps // 10, steps // 100
    found = {
        C: Side(partial(sides.bare_c, lag, True, loops=loops), steps),
        OURS: Side(partial(sides.compiled, lag, True, loops=loops), steps),
        C_NO_ROWS: Side(partial(sides.bare_c, lag, False, loops=loops), steps),
        OURS_NO_ROWS: Side(partial(sides.compiled, lag, False, loops=loops), steps),
        CONTROLLER: Side(partial(sides.bare_python_controller, loops=loops), some),
        OURS_PYTHON: Side(partial(sides.plain_python, lag, loops=loops), some),
    }
    fmpys = {
        LOW: Side(partial(sides.fmpy_low_level, lag, unpacked, True), few),
        METHODS: Side(partial(sides.fmpy_low_level, lag, unpacked, False), few),
        SIMULATE: Side(partial(sides.fmpy_simulate, lag, unpacked), few, 1e-12),
    }
    return found if loops > 1 else found | fmpys


def measure(
    folder: Path, fmi_version: int, steps: int, repeats: int, loops: Sequence[int] = LOOPS
) -> dict[int, dict[str, Series]]:
    """All sides for one FMI version, ns per macro step and loop, by the number of loops."""
    lag = build_lag(folder, fmi_version)
    unpacked = Path(fmpy.extract(str(lag.fmu), str(lag.fmu.with_suffix(""))))
    ends: dict[int, tuple[float, float] | None] = {}

    def nanoseconds(name: str, side: Side, n: int) -> float:
        if side.steps not in ends:
            ends[side.steps] = sides.bare_c(lag, False, side.steps).last
        measured, right = side.run(side.steps), ends[side.steps]
        for value, expected in zip(measured.last or (), right or (), strict=False):
            if not math.isclose(value, expected, rel_tol=side.tolerance, abs_tol=0.0):
                raise SystemExit(f"{name} ends at {measured.last}, not at {right}")
        return measured.nanoseconds / n

    chosen = {
        (n, name): partial(nanoseconds, name, side, n)
        for n in loops
        for name, side in sides_of(lag, unpacked, _share(steps, n), n).items()
    }
    keys = {f"{name}, {n}": (n, name) for n, name in chosen}
    found = interleaved({key: chosen[place] for key, place in keys.items()}, repeats)
    return {n: {name: found[k] for k, (m, name) in keys.items() if m == n} for n in loops}


def _share(steps: int, loops: int) -> int:
    """Steps of so many loops side by side, in thousands for the sides with few rows."""
    return max(100_000, steps // loops // 10_000 * 10_000)


def ratios(results: dict[str, Series], name: str) -> tuple[float, ...]:
    """To the baseline of `name`, round by round."""
    baseline = results[BASELINE.get(name, C)]
    return tuple(a / b for a, b in zip(results[name].values, baseline.values, strict=True))


def table(fmi_version: int, results: dict[int, dict[str, Series]]) -> Table:
    """Medians and minima in ns, ratios to the baseline."""
    made = Table(title=f"Closed loop, FMI {fmi_version}, per macro step and loop", box=SIMPLE)
    made.add_column("loops", justify="right")
    made.add_column("", no_wrap=True)
    for heading in ("median ns", "min ns", "ratio", "from", "to", "bound"):
        made.add_column(heading, justify="right", no_wrap=True)
    for loops, of in results.items():
        for name, series in of.items():
            cells = [f"{series.median:.1f}", f"{series.minimum:.1f}"]
            if name in {*BASELINE, LOW, METHODS, SIMULATE}:
                one = ratios(of, name)
                cells += [f"{x:.3g}" for x in (statistics.median(one), min(one), max(one))]
                cells += [f"{BOUND[name]:g}"] if name in BOUND and loops == 1 else []
            made.add_row(str(loops), name, *cells)
    return made


def report(results: dict[int, dict[int, dict[str, Series]]]) -> dict[str, Any]:
    """For the JSON file."""
    return {
        f"fmi{fmi_version}": {
            str(loops): {
                name: {"ns": series.as_json(), "ratios": list(ratios(of, name))}
                for name, series in of.items()
            }
            for loops, of in by_loops.items()
        }
        for fmi_version, by_loops in results.items()
    }


def main(argv: Sequence[str] | None = None) -> None:
    """Measure, print, and fail where a median is above its bound."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=4_000_000, help="macro steps of one loop")
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--loops", type=int, nargs="+", default=list(LOOPS))
    parser.add_argument("--fmi", type=int, nargs="+", default=[2, 3])
    parser.add_argument("--json", type=Path, help="write all measurements there")
    options = parser.parse_args(argv)
    console = Console(width=110)
    console.print(*machine().values(), sep="\n")
    results = {}
    for fmi_version in options.fmi:
        with tempfile.TemporaryDirectory() as folder:
            results[fmi_version] = measure(
                Path(folder), fmi_version, options.steps, options.repeats, options.loops
            )
        console.print(table(fmi_version, results[fmi_version]))
    if options.json:
        write_json(options.json, {"unit": "ns per macro step and loop", **report(results)})
    broken = [
        f"FMI {version}: {name}"
        for version, by_loops in results.items()
        for loops, of in by_loops.items()
        if loops == 1
        for name, bound in BOUND.items()
        if statistics.median(ratios(of, name)) > bound
    ]
    if broken:
        raise SystemExit("above its bound: " + "; ".join(broken))


if __name__ == "__main__":
    main()
