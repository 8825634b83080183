"""What the worker process costs. `python -m benchmarks.supervised`.

    start-up    ms from the call to the result of a run of one step, in process and in a worker
    step        ns of wall time per macro step of a closed loop, all recorded: the slope between a
                short and a long run, so that start-up does not count

Both sides run in turn, so that what disturbs the machine disturbs both. On one core (`--one-core`)
the supervisor takes its time from the worker; on two it works beside it.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from rich.console import Console

from benchmarks.lag import Lag, build_lag
from benchmarks.measuring import Series, interleaved, machine
from benchmarks.run_overhead import loops, table


def seconds(lag: Lag, steps: int, folder: Path | None, *, in_process: bool) -> float:
    """Wall time of a whole run, into memory or a new folder."""
    bench = loops(lag, 1, steps)
    place = None if folder is None else Path(tempfile.mkdtemp(dir=folder)) / "run"
    began = time.perf_counter()
    bench.run(place, in_process=in_process)
    return time.perf_counter() - began


def per_step(lag: Lag, steps: int, *, in_process: bool) -> float:
    """ns per macro step."""
    short = seconds(lag, steps // 10, None, in_process=in_process)
    long = seconds(lag, steps, None, in_process=in_process)
    return 1e9 * (long - short) / (0.9 * steps)


def differences(one: Series, other: Series) -> Series:
    """other − one, round by round."""
    return Series(tuple(b - a for a, b in zip(one.values, other.values, strict=True)))


def spread(series: Series) -> list[str]:
    """Median, quartiles, least, as cells."""
    low, _, high = statistics.quantiles(series.values, n=4)
    return [f"{series.median:.1f}", f"{low:.1f} … {high:.1f}", f"{series.minimum:.1f}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=4_000_000)
    parser.add_argument("--repeats", type=int, default=11)
    parser.add_argument("--one-core", action="store_true", help="both processes share a core")
    options = parser.parse_args()
    if options.one_core:
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    console = Console(width=100)
    console.print(*machine().values(), sep="\n")
    modes = {"in process": True, "in a worker": False}
    with tempfile.TemporaryDirectory() as folder:
        lag = build_lag(Path(folder), 3)
        starts: dict[str, Callable[[], float]] = {
            f"{name}, {kind}": partial(seconds, lag, 1, place, in_process=here)
            for name, here in modes.items()
            for kind, place in (("rows in memory", None), ("rows in a folder", Path(folder)))
        }
        measured = interleaved(starts, options.repeats)
        rows = [[name, f"{1e3 * series.minimum:.1f}"] for name, series in measured.items()]
        console.print(table("Start-up, second run of a process", ["", "ms"], rows))
        steps: dict[str, Callable[[], float]] = {
            name: partial(per_step, lag, options.steps, in_process=here)
            for name, here in modes.items()
        }
        measured = interleaved(steps, options.repeats)
        rows = [[name, *spread(series)] for name, series in measured.items()]
        rows.append(["difference, round by round", *spread(differences(*measured.values()))])
        headings = ["ns of wall time per macro step", "median", "quartiles", "least"]
        console.print(table("Closed loop", headings, rows))


if __name__ == "__main__":
    main()
