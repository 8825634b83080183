"""Does the cost of one more stay what it is? Samples, variables, FMUs, runs."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.frame import Aim, Comparison, Setting, Side
from benchmarks.lag import Lag, build_lag
from benchmarks.pi import STEP
from benchmarks.run_overhead import count_step, loops
from benchmarks.timed_run import timed_run
from harness.bench import Bench
from harness.system.block import KernelBlock, Port

SAMPLES = (10**3, 10**4, 10**5, 10**6, 10**7)
VARIABLES = (1, 10, 100, 1000, 10_000)
LOOPS = (1, 4, 16, 64, 250, 1000)
RUNS = (1, 10, 100, 1000, 10_000)
CELLS = 4_000_000
"""Rows times columns of a run over variables, steps times loops of one over FMUs."""
MEMORY = """
import re, sys
from pathlib import Path
from benchmarks.cases.growth import streamed
from benchmarks.lag import Lag
lag = Lag(3, Path(sys.argv[1]), Path())
streamed(lag, int(sys.argv[2]), Path(sys.argv[3]))
print(int(re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())[1]) / 1024)
"""
LEVEL = "Something that is done for each grows with their number: see the line above."


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """Time for one more, over how many there are."""
    lag = build_lag(Path(tempfile.mkdtemp(dir=setting.folder)), 3)
    yield samples(lag, setting.folder)
    yield memory(lag, setting.folder)
    sides = _sides(VARIABLES, partial(variables, lag))
    yield _comparison("variables", "recorded variables", "ns a value", VARIABLES, sides, 100)
    sides = _sides(VARIABLES[2:], partial(stored, lag, setting.folder))
    yield _comparison(
        "stored", "variables recorded into a folder", "ns a value", VARIABLES[2:], sides, 100
    )
    yield _comparison(
        "fmus", "closed loops", "ns a step", LOOPS, _sides(LOOPS, partial(fmus, lag)), 4
    )
    prepared = setting.undo.enter_context(loops(lag, 1, 500).prepare())
    sides = _sides(RUNS, partial(runs, prepared.run))
    yield _comparison("runs", "runs of one prepared system", "µs a run", RUNS, sides, 100)


def _sides(sizes: Sequence[int], measure: Callable[[int], float]) -> dict[str, Side]:
    return {f"{size:,}": Side(partial(measure, size)) for size in sizes}


def _comparison(
    name: str, axis: str, unit: str, sizes: Sequence[int], sides: dict[str, Side], middle: int
) -> Comparison:
    """`middle` is the size with which the largest is compared: below it, beginnings count."""
    largest = f"{sizes[-1]:,}"
    aim = Aim(f"level to {largest} {axis}", largest, 1.5, LEVEL, against=f"{middle:,}")
    return Comparison(
        f"growth_{name}", f"Growth: {axis}", unit, sides, f"{middle:,}", (aim,), axis,
        tuple(map(float, sizes)),
    )  # fmt: skip


def samples(lag: Lag, folder: Path) -> Comparison:
    """A closed loop into a folder, with CSV and Parquet: wall time a sample."""
    sides = _sides(SAMPLES, lambda n: streamed(lag, n, folder) / n * 1e6)
    largest = f"{SAMPLES[-1]:,}"
    aims = (
        Aim("1e7 samples to a folder, a sample", largest, 1.0,
            "CSV: a number in text costs some 100 ns; Parquet alone is a tenth of it."),
        Aim("level to 10,000,000 samples", largest, 1.5, LEVEL, against="1,000,000"),
    )  # fmt: skip
    return Comparison(
        "growth_samples", "Growth: samples of a closed loop into a folder", "µs a sample", sides,
        "1,000,000", aims, "samples", tuple(map(float, SAMPLES)),
        "Four columns and the time, as Parquet and CSV.",
    )  # fmt: skip


def streamed(lag: Lag, steps: int, folder: Path) -> float:
    """Seconds of a supervised run into a new folder, which is removed."""
    bench = loops(lag, 1, steps)
    with tempfile.TemporaryDirectory(dir=folder) as place:
        began = time.perf_counter()
        result = bench.run(Path(place) / "run")
        seconds = time.perf_counter() - began
        assert len(result.time) == steps + 1
    return seconds


def memory(lag: Lag, folder: Path) -> Comparison:
    """What the caller's process takes at its highest for the same."""

    def peak(steps: int) -> float:
        command = [sys.executable, "-c", MEMORY, str(lag.fmu), str(steps), str(folder)]
        return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

    sides = {f"{n:,}": Side(partial(peak, n), rounds=1) for n in SAMPLES}
    aim = Aim(
        "memory of 1e7 samples to a folder", f"{SAMPLES[-1]:,}", 500.0,
        "Half of it is what is imported; a column that is looked at is 80 MB.",
    )  # fmt: skip
    return Comparison(
        "growth_memory", "Growth: memory of a run into a folder", "MB", sides, "1,000",
        (aim,), "samples", tuple(map(float, SAMPLES)),
    )  # fmt: skip


def variables(lag: Lag, count: int) -> float:
    """Nanoseconds a recorded value, kept in memory, of a block with so many outputs."""
    system = wide(lag, count, max(200, CELLS // (count + 10))).system()
    return timed_run(system, ("wide.y*",)).nanoseconds / count


def stored(lag: Lag, folder: Path, count: int) -> float:
    """The same into a folder, wall time, a run of a quarter of the rows taken off."""

    def seconds(rows: int) -> float:
        with tempfile.TemporaryDirectory(dir=folder) as place:
            began = time.perf_counter()
            wide(lag, count, rows).run(Path(place) / "run")
            return time.perf_counter() - began

    rows = 2 * CELLS // count
    return 1e9 * (seconds(rows) - seconds(rows // 4)) / (0.75 * rows * count)


def wide(lag: Lag, count: int, steps: int) -> Bench:
    """An FMU, and a block with so many outputs."""
    bench = Bench(stop_time=steps * STEP, step=STEP, record=["wide.y*"])
    ports = tuple(Port(f"y{i}") for i in range(count))
    block = KernelBlock((Port("y"),), ports, count_step, np.zeros(0), np.zeros(1))
    bench.fmu("plant", lag.fmu)
    bench.controller("wide", block)
    bench.connect("plant.y", "wide.y")
    return bench


def fmus(lag: Lag, count: int) -> float:
    """Nanoseconds a step and loop of so many closed loops in one system."""
    system = loops(lag, count, max(200, CELLS // 4 // count)).system()
    return timed_run(system, ("plant0.y",)).nanoseconds / count


def runs(run: Callable[[], object], count: int) -> float:
    """Microseconds a run, of so many one after the other."""
    began = time.thread_time()
    for _ in range(count):
        run()
    return 1e6 * (time.thread_time() - began) / count
