"""What a run costs besides its steps. `python -m benchmarks.run_overhead`.

    start-up    the phases of a first run in a fresh process, with FMU and machine code in caches
    recording   ns per macro step for one more column, one more signal
    scaling     ns per macro step and loop for 1 to 64 closed loops in one system; must stay level
    planning    seconds for cycles of ten thousand to a million actions; must grow with them

All figures are processor time; the least of some repetitions counts.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import numpy as np
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from benchmarks.lag import Lag, build_lag
from benchmarks.measuring import interleaved, machine, write_json
from benchmarks.pi import STEP, pi_block
from benchmarks.timed_run import timed_run
from harness.bench import Bench
from harness.compiler.operations import CLOCK_SIZE
from harness.master.opened import descriptions_of, opened
from harness.master.program.link import Linker
from harness.master.run import plan_system
from harness.participants.fmu import Around, FmuParticipant
from harness.participants.kinds import sampled
from harness.participants.participant import Participant
from harness.system.block import Array, KernelBlock, Port
from harness.system.graph import System

LOOPS = (1, 4, 16, 64)
ACTIONS = (10_000, 100_000, 900_000)
COLUMNS = SIGNALS = 32

_FIRST_RUN = """
import json, time
phases, mark = {}, time.process_time()
def phase(name):
    global mark
    now = time.process_time()
    phases[name] = 1e3 * (now - mark)
    mark = time.process_time()
from harness.bench import Bench
from harness.master.opened import opened
from harness.master.run import execute, plan_system
phase("import the harness, numba and FMPy with it")
bench = Bench(stop_time=0.01)
bench.fmu("plant", "hybrid_actuator")
phase("find the plant's FMU in the cache")
bench.controller("controller", "pid", kp=2e-5)
bench.signal("reference", "step", time=0.1, final=2000.0, unit="N")
bench.connect("reference", "controller.reference")
bench.connect("plant.force", "controller.measured")
bench.connect("controller.u", "plant.command")
system = bench.system()
phase("assemble the system")
class Nothing:
    def append(self, times, rows): pass
with opened(system) as fmus:
    phase("unpack the FMU, validate and read its description")
    plan = plan_system(system, fmus)
    phase("check and plan")
    for name in ("first run of two instants: load library and machine code", "second run of them"):
        outcome = execute(plan, fmus, Nothing())
        if outcome.fault: raise outcome.fault
        phase(name)
print(json.dumps(phases))
"""


def start_up(repeats: int) -> dict[str, float]:
    """Milliseconds by phase; the least total of fresh processes, after one that fills caches."""

    def once() -> dict[str, float]:
        command = [sys.executable, "-c", _FIRST_RUN]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        phases: dict[str, float] = json.loads(done.stdout)
        return phases

    once()
    return min((once() for _ in range(repeats)), key=lambda phases: sum(phases.values()))


def count_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """x = (samples so far,), the first output; the others stay as they are."""
    x[0] += 1.0
    y[0] = x[0]


def wide_system(lag: Lag, steps: int, signals: dict[str, str]) -> System:
    """A closed loop, a block with outputs to record, and signals that nobody reads."""
    bench = loops(lag, 1, steps)
    ports = tuple(Port(f"y{i}") for i in range(COLUMNS))
    bench.controller("wide", KernelBlock((), ports, count_step, np.zeros(0), np.zeros(1)))
    for name, kind in signals.items():
        parameters = {"std": 1.0} if kind == "white_noise" else {"amplitude": 1.0, "frequency": 1.0}
        bench.signal(name, kind, **parameters)
    return bench.system()


def loops(lag: Lag, n: int, steps: int) -> Bench:
    """n closed loops side by side."""
    bench = Bench(stop_time=steps * STEP, step=STEP)
    for i in range(n):
        bench.fmu(f"plant{i}", lag.fmu)
        bench.controller(f"controller{i}", pi_block())
        bench.connect(f"plant{i}.y", f"controller{i}.y")
        bench.connect(f"controller{i}.u", f"plant{i}.u")
    return bench


def per_step(system: System, record: tuple[str, ...], shares: int = 1) -> float:
    """ns per macro step, divided by `shares`."""
    return timed_run(system, record).nanoseconds / shares


def recording_and_signals(lag: Lag, steps: int, repeats: int) -> dict[str, float]:
    """ns per macro step for one more of each."""
    bare = wide_system(lag, steps, {})
    sides: dict[str, Callable[[], float]] = {
        "nothing": partial(per_step, bare, ("plant0.y",)),
        "recorded column": partial(per_step, bare, ("plant0.y", "wide.*")),
    }
    for kind in ("sine", "white_noise"):
        system = wide_system(lag, steps, {f"signal{i}": kind for i in range(SIGNALS)})
        sides[f"signal, {kind}"] = partial(per_step, system, ("plant0.y",))
    measured = {name: series.minimum for name, series in interleaved(sides, repeats).items()}
    nothing = measured.pop("nothing")
    more = {"recorded column": COLUMNS}
    return {name: (ns - nothing) / more.get(name, SIGNALS) for name, ns in measured.items()}


def scaling(lag: Lag, steps: int, repeats: int) -> dict[int, tuple[float, float]]:
    """By number of loops: ns per macro step and loop, recorded and not."""
    systems = {n: loops(lag, n, steps // n).system() for n in LOOPS}
    sides: dict[str, Callable[[], float]] = {}
    for n, system in systems.items():
        sides[f"{n} recorded"] = partial(per_step, system, ("*",), n)
        sides[f"{n} bare"] = partial(per_step, system, (), n)
    measured = interleaved(sides, repeats)
    return {n: (measured[f"{n} recorded"].minimum, measured[f"{n} bare"].minimum) for n in LOOPS}


def planning(lag: Lag, actions: int) -> tuple[int, float, float]:
    """Actions of the cycle, seconds to plan and to link them.

    A fast block and its plant beside a controller so slow that the cycle has that many actions.
    """
    fast, per_instant = 1e-5, 6
    n = actions // per_instant
    bench = Bench(stop_time=n * fast, step=fast, record_step=n * fast)
    bench.fmu("plant", lag.fmu)
    bench.controller("slow", pi_block(), sample_time=n * fast)
    bench.controller("fast", pi_block())
    bench.connect("plant.y", "slow.y")
    bench.connect("slow.u", "plant.u")
    bench.connect("plant.y", "fast.y")
    system = bench.system()
    clock = np.zeros(CLOCK_SIZE, dtype=np.int64)
    with opened(system) as fmus, ExitStack() as stack:
        marks = [time.thread_time()]
        plan = plan_system(system, fmus)
        marks.append(time.thread_time())
        participants: dict[str, Participant] = {}
        for fmu in plan.lowered.fmus:
            made = FmuParticipant.of(fmu, fmus[fmu.name], Around())
            stack.callback(made.close)
            made.enter_initialization(0.0, 1.0)
            participants[fmu.name] = made
        participants |= {c.name: sampled(c) for c in plan.lowered.sampled}
        marks.append(time.thread_time())
        Linker(plan, participants, descriptions_of(system, fmus), clock).link()
        marks.append(time.thread_time())
    planned = sum(len(instant.actions) for instant in plan.instants)
    return planned, marks[1] - marks[0], marks[3] - marks[2]


def table(title: str, headings: list[str], rows: list[list[str]]) -> Table:
    """A plain table, numbers to the right."""
    made = Table(title=title, box=SIMPLE, title_justify="left")
    for i, heading in enumerate(headings):
        made.add_column(heading, justify="right" if i else "left", no_wrap=True)
    for row in rows:
        made.add_row(*row)
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=500_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write all measurements there")
    options = parser.parse_args()
    console = Console(width=100)
    console.print(*machine().values(), sep="\n")
    phases = start_up(options.repeats)
    rows = [[name, f"{ms:.1f}"] for name, ms in phases.items()]
    console.print(table("Start-up", ["phase", "ms"], [*rows, ["", f"{sum(phases.values()):.0f}"]]))
    with tempfile.TemporaryDirectory() as folder:
        lag = build_lag(Path(folder), 3)
        costs = recording_and_signals(lag, options.steps, options.repeats)
        rows = [[name, f"{ns:.1f}"] for name, ns in costs.items()]
        console.print(table("One more of it", ["", "ns per macro step"], rows))
        level = scaling(lag, options.steps, options.repeats)
        rows = [[str(n), f"{a:.1f}", f"{b:.1f}"] for n, (a, b) in level.items()]
        headings = ["closed loops", "ns per step and loop, all recorded", "no columns"]
        console.print(table("Scaling", headings, rows))
        planned = [planning(lag, actions) for actions in (ACTIONS[0], *ACTIONS)][1:]
        rows = [[str(n), f"{a:.3f}", f"{b:.3f}"] for n, a, b in planned]
        console.print(table("Planning", ["actions of the cycle", "plan, s", "link, s"], rows))
    if options.json:
        results = {"start_up_ms": phases, "ns": costs, "scaling_ns": level, "planning_s": planned}
        write_json(options.json, results)


if __name__ == "__main__":
    main()
