"""The closed loop with a trivial FMU: ours, bare C, FMPy, and every peer."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import fmpy

from benchmarks import closed_loop, sides
from benchmarks.frame import Aim, Comparison, RefusedError, Setting, Side
from benchmarks.lag import Lag, build_lag
from benchmarks.peers.environments import CALLBACK, FMUS, PEERS, titled
from benchmarks.peers.loop import expected, measured, task_of
from benchmarks.pi import STEP
from benchmarks.timed_run import timed_run
from harness.bench import Bench

STEPS = 2_000_000
UNIT = "ns a step"


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """Bare C is the limit; a peer's answer counts if its numbers are those of the equations."""
    lags = {version: build_lag(setting.folder, version) for version in (2, 3)}
    for version, lag in lags.items():
        yield closed(lag, version)
    yield side_by_side(lags[3])
    lag = lags[2]
    ours = {
        "ours, compiled controller": Side(partial(_checked, lag, closed_loop.OURS)),
        "ours, Python controller": Side(partial(_checked, lag, closed_loop.OURS_PYTHON)),
    }
    task = task_of(lag)
    note = "A trivial plant (FMI 2) and a PI controller; processor time of all threads."
    for name, loop, own in (
        ("peers_callback", CALLBACK, ours),
        ("peers_fmus", FMUS, {"ours": Side(partial(coupled, lag, Path(task.controller)))}),
    ):
        asked = [peer for peer in setting.peers if PEERS[peer].loop == loop]
        theirs = {titled(peer): Side(partial(measured, peer, task)) for peer in asked}
        title = f"Closed loop in every tool, {loop}"
        yield Comparison(name, title, UNIT, {**own, **theirs}, next(iter(own)), note=note)


def closed(lag: Lag, version: int) -> Comparison:
    """The loop of `benchmarks.closed_loop`, every side at the bits of the C program."""
    names = closed_loop.sides_of(lag, lag.fmu, STEPS)
    chosen = {name: Side(partial(_checked, lag, name)) for name in names}
    aims = (
        Aim(
            f"closed loop, FMI {version}, compiled controller", closed_loop.OURS, 1.2,
            "Rows go to a recorder into fresh memory, which C has touched before; the loop itself "
            "is level with C.",
            against=closed_loop.C,
        ),
        Aim(
            f"closed loop, FMI {version}, Python controller, above itself",
            closed_loop.OURS_PYTHON, 150.0,
            "The interpreter lock is taken for each call, and a float made of each input.",
            against=closed_loop.CONTROLLER, above=True,
        ),
    )  # fmt: skip
    return Comparison(
        f"closed_loop_fmi{version}", f"Closed loop, FMI {version}", UNIT, chosen, closed_loop.C,
        aims,
    )  # fmt: skip


_UNPACKED: dict[Path, Path] = {}


def _checked(lag: Lag, name: str, loops: int = 1) -> float:
    """Nanoseconds a step and loop of one side, which must end where the C program does."""
    if lag.fmu not in _UNPACKED:
        _UNPACKED[lag.fmu] = Path(fmpy.extract(str(lag.fmu), str(lag.fmu.with_suffix(""))))
    steps = STEPS if loops == 1 else max(100_000, STEPS // loops // 10_000 * 10_000)
    side = closed_loop.sides_of(lag, _UNPACKED[lag.fmu], steps, loops)[name]
    found, end = side.run(side.steps), sides.bare_c(lag, False, side.steps).last
    for value, right in zip(found.last or (), end or (), strict=False):
        if not math.isclose(value, right, rel_tol=side.tolerance, abs_tol=0.0):
            raise RefusedError(f"ends at {found.last}, not at {end}")
    return found.nanoseconds / loops


def side_by_side(lag: Lag) -> Comparison:
    """4 to 64 closed loops in one system, a row in 1000: ours against C."""
    pairs = {closed_loop.C_NO_ROWS: "bare C, {} loops", closed_loop.OURS_NO_ROWS: "ours, {} loops"}
    chosen, aims = {}, []
    for loops in closed_loop.LOOPS[1:]:
        c, ours = (shown.format(loops) for shown in pairs.values())
        for name, shown in pairs.items():
            chosen[shown.format(loops)] = Side(partial(_checked, lag, name, loops))
        words = "Straight code of many loops is longer than the caches of instructions."
        aims.append(Aim(f"closed loop, {loops} FMUs", ours, 1.2, words, against=c))
    title = "Closed loops side by side, FMI 3"
    return Comparison("closed_loops", title, "ns a step and loop", chosen, aims=tuple(aims))


def coupled(lag: Lag, controller: Path) -> float:
    """Nanoseconds a step of ours with the controller as an FMU, by Jacobi."""
    bench = Bench(stop_time=STEPS * STEP, step=STEP, algorithm="jacobi")
    bench.fmu("plant", lag.fmu)
    bench.fmu("controller", controller)
    bench.connect("plant.y", "controller.y")
    bench.connect("controller.u", "plant.u")
    run = timed_run(bench.system(), ("plant.y", "controller.u"))
    found, right = float(run.result["plant.y"][150]), expected(150, 1)
    if not math.isclose(found, right, rel_tol=1e-12):
        raise RefusedError(f"y is {found:.9g} after 150 steps, not {right:.9g}")
    return run.nanoseconds
