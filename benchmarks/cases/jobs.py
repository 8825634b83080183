"""Whole jobs, as a user waits for them: the rows of the table of what is wanted."""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import fmpy

from benchmarks import lead_script
from benchmarks.cases.commands import HARNESS, processor, seconds, timed
from benchmarks.frame import Aim, Comparison, RefusedError, Setting, Side
from benchmarks.lag import build_lag
from benchmarks.peers.loop import ROOT
from benchmarks.special_fmus import talkative_fmu, wide_fmu
from harness import registry, simulate
from harness.bench import Bench
from harness.experiment.experiment import Experiment
from harness.fmi.fmu import Fmu

LEAD = "ahn2009/figure_11"
FIVE = [
    word
    for name in ("pid", "fuzzy_pid", "ekf", "robust_ekf", "pid_top")
    for word in ("--variant", name)
]
"""The controllers that the aims were set for."""
SAMPLE_AIM = 117.0
"""µs: a third of what a sample took when it was first measured."""
MESSAGES, STEPS = 50_000, 2_000_000


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """All of them, each against what it is to be compared with."""
    yield start()
    yield lead(setting.folder)
    yield sample(setting)
    yield wide(setting.folder)
    yield messages(setting.folder)
    yield simulated(setting.folder)


def start() -> Comparison:
    """The command that does nothing."""
    numpy = Side(partial(timed, [sys.executable, "-c", "import numpy"]))
    sides = {"import numpy": numpy, "ours, --help": Side(partial(seconds, "--help"))}
    limit = "What the first screen needs is imported at its start: typer, rich and the commands."
    aim = Aim("`--help`", "ours, --help", 0.15, limit)
    return Comparison("start", "Start of a command", "s", sides, "import numpy", (aim,))


def lead(folder: Path) -> Comparison:
    """The lead experiment: first and again, and its PID against a script on FMPy."""
    script = folder / "script"
    first, again = "ours, five controllers, first run", "ours, five controllers"
    pid, theirs = "ours, PID alone", "a script on FMPy, PID alone"
    sides = {
        "import numpy": Side(partial(timed, [sys.executable, "-c", "import numpy"])),
        first: Side(partial(fresh, folder), rounds=3),
        again: Side(partial(run_lead, folder, *FIVE)),
        pid: Side(partial(run_lead, folder, "--variant", "pid")),
        theirs: Side(partial(scripted, script)),
    }
    aims = (
        Aim("first `run ahn2009/figure_11` after the installation", first, 15.0,
            "numba's type inference of the controllers; it would take machine code that is "
            "shipped, or controllers that are compiled by C."),
        Aim("the same, warm", again, 2.0,
            "Imports of numba, matplotlib, networkx and pydantic, some 1 s, and 0.2 s of processor "
            "a variant; it would take machine code that is loaded without numba."),
        Aim("its PID against a script on FMPy", pid, 1.0,
            "Imports; the script needs neither numba nor pydantic.", against=theirs),
    )  # fmt: skip
    note = (
        "Wall time of commands: rows, pictures and tables. The script is "
        "[docs/pid_loop_with_fmpy.py](pid_loop_with_fmpy.py); its rows are ours, bit for bit."
    )
    return Comparison("lead", "The lead experiment", "s", sides, "import numpy", aims, note=note)


def run_lead(folder: Path, *more: str) -> float:
    """Everything cached, into a new folder."""
    output = tempfile.mkdtemp(dir=folder)
    return seconds("run", LEAD, "--output", f"{output}/out", *more)


def fresh(folder: Path) -> float:
    """As on a machine where nothing has run: a copy of the packages without caches."""
    place = Path(tempfile.mkdtemp(dir=folder))
    for package in ("harness", "controllers", "fmus", "experiments"):
        shutil.copytree(
            ROOT / package, place / package, ignore=shutil.ignore_patterns("__pycache__")
        )
    variables = {"XDG_CACHE_HOME": str(place / "cache"), "PYTHONPATH": str(place)}
    command = [sys.executable, "-c", HARNESS, "run", LEAD, "--output", "out", *FIVE]
    try:
        return timed(command, place, variables)
    finally:
        shutil.rmtree(place)


def scripted(folder: Path) -> float:
    """The script on FMPy, whose rows must be ours to the bit."""
    if not folder.exists():
        command = lead_script.prepared(folder)
        (folder / "command").write_text("\n".join(command))
    taken = timed((folder / "command").read_text().splitlines())
    if apart := lead_script.difference(folder):
        raise RefusedError(f"its rows differ from ours by {apart:.1e}")
    return taken


def sample(setting: Setting) -> Comparison:
    """Two coupled plants and the robust EKF, prepared: what a sample takes."""
    experiment = Experiment.load(registry.experiment(LEAD))
    variants = {name: experiment.prepare(name) for name in ("pid", "robust_ekf")}
    for one in variants.values():
        setting.undo.enter_context(one)

    def microseconds(name: str) -> float:
        began = time.thread_time()
        rows = len(variants[name].run().time)
        return 1e6 * (time.thread_time() - began) / rows

    sides = {f"ours, {name}": Side(partial(microseconds, name)) for name in variants}
    aim = Aim(
        "a sample of the coupled lead plant with robust EKF", "ours, robust_ekf", SAMPLE_AIM,
        "Two `doStep`s that each begin behind a jump of their input.",
    )  # fmt: skip
    title = "One sample of two coupled plants, rows kept in memory"
    return Comparison("sample", title, "µs", sides, aims=(aim,))


def wide(folder: Path) -> Comparison:
    """An FMU of 20 000 variables."""
    fmu = wide_fmu(folder)

    def opened() -> float:
        began = time.perf_counter()
        with Fmu(fmu):
            return time.perf_counter() - began

    def fmpy_reads() -> float:
        began = time.perf_counter()
        fmpy.read_model_description(str(fmu))
        return time.perf_counter() - began

    sides = {
        "FMPy, read_model_description": Side(fmpy_reads),
        "ours, import": Side(opened),
        "ours, info": Side(partial(seconds, "info", str(fmu))),
        "ours, info --json": Side(partial(seconds, "info", str(fmu), "--json")),
    }
    limit = "One pass over the XML and one over the names; rich lays out every line of a table."
    aims = (
        Aim("`info` on 20 000 variables", "ours, info", 2.0, limit),
        Aim("`info --json` on 20 000 variables", "ours, info --json", 1.0, limit),
        Aim("import of 20 000 variables", "ours, import", 1.0, limit),
    )
    return Comparison(
        "wide", "20 000 variables", "s", sides, "FMPy, read_model_description", aims
    )  # fmt: skip


def messages(folder: Path) -> Comparison:
    """An FMU that logs a message in each step, less one that does not; processor time."""
    talkative, quiet = talkative_fmu(folder), build_lag(_new(folder), 2).fmu

    def microseconds(*more: str) -> float:
        common = ("--stop-time", f"{MESSAGES}", "--step-size", "1", *more)
        marks = [processor()]
        for fmu in (quiet, talkative):
            seconds("simulate", str(fmu), *common)
            marks.append(processor())
        return 1e6 * (marks[2] - 2.0 * marks[1] + marks[0]) / MESSAGES

    shown = "ours, simulate --fmi-logging"
    sides = {
        "ours, simulate": Side(microseconds),
        shown: Side(partial(microseconds, "--fmi-logging")),
    }
    limit = "Each message is formatted, judged and put into the ring by Python."
    aims = (
        Aim("FMI log messages, not shown", "ours, simulate", 1.0, limit),
        Aim("FMI log messages, `--fmi-logging`", shown, 5.0, limit),
    )
    return Comparison("messages", "A message of an FMU", "µs", sides, aims=aims)


def simulated(folder: Path) -> Comparison:
    """`simulate` in a worker and in the caller's process, and the same FMU alone in a loop;
    processor time, a shorter run taken off."""
    fmu = build_lag(_new(folder), 2).fmu

    def looped(stop: float, in_process: bool) -> None:
        bench = Bench(stop_time=stop, step=0.01)
        bench.fmu("lag", fmu)
        bench.run(in_process=in_process)

    def simulates(stop: float, in_process: bool) -> None:
        simulate(fmu, stop_time=stop, step_size=0.01, in_process=in_process)

    def microseconds(run: Callable[[float, bool], None], in_process: bool) -> float:
        marks = [processor()]
        for steps in (STEPS, 100):
            run(0.01 * steps, in_process)
            marks.append(processor())
        return 1e6 * (2.0 * marks[1] - marks[0] - marks[2]) / STEPS

    loop, apart = "ours, the loop in a worker", "ours, simulate in a worker"
    sides = {
        loop: Side(partial(microseconds, looped, False)),
        "ours, simulate in process": Side(partial(microseconds, simulates, True)),
        apart: Side(partial(microseconds, simulates, False)),
    }
    aim = Aim(
        "`simulate` in a worker, a step", apart, 1.5,
        "Python calls compiled code for each step, and goes on where that is no plain success.",
        against=loop,
    )  # fmt: skip
    return Comparison("simulate", "A step of `simulate`", "µs", sides, loop, (aim,))


def _new(folder: Path) -> Path:
    return Path(tempfile.mkdtemp(dir=folder))
