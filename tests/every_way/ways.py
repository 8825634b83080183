"""The ways of running an FMU with the harness. Each gives rows as the plain driver does: what is
watched at 0, step, 2 step, … after what happens then; None in place of a row that a way does not
have."""

import inspect
import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness import Bench, Fmu, simulate
from harness.inspection.subject import Subject
from harness.inspection.trial import Trial
from harness.instruments.source import FunctionSampler
from harness.participants.track_data import read_inputs
from tests.every_way.cases import Case
from tests.every_way.plain_driver import drive
from tests.every_way.plain_events import SECOND, Job, Steps
from tests.loops import straight_code

Rows = dict[str, list[Any]]


@dataclass(frozen=True)
class Staircase:
    """A signal of constant pieces."""

    steps: Steps
    unit: str | None = None

    def sampler(self, seed: Any) -> FunctionSampler:
        times = np.array([t for t, _ in self.steps])
        values = np.array([float(v) for _, v in self.steps])
        return FunctionSampler(lambda ns: values[np.searchsorted(times, ns, side="right") - 1])


def _at(steps: Steps, seconds: float) -> Any:
    return [value for ns, value in steps if ns <= seconds * SECOND][-1]


def _tracks(case: Case) -> dict[str, Any]:
    """The inputs as `simulate` takes them: a time that repeats is a jump."""
    found = {}
    for name, steps in case.inputs.items():
        times, rows = [0.0], [steps[0][1]]
        for (ns, after), (_, before) in zip(steps[1:], steps, strict=False):
            times += [ns / SECOND] * 2
            rows += [before, after]
        found[name] = (times, rows)
    for name, ticks in case.triggers.items():
        found[name] = ([0.0, *(ns / SECOND for ns in ticks)], [False, *(True for _ in ticks)])
    return found


def _columns(job: Job, times: Any, names: list[str], column: Callable[[str], Any]) -> Rows:
    """The last row at each communication point, the elements of an array side by side."""
    grid = np.arange(job.steps + 1) * job.step_ns
    ns = np.round(np.asarray(times) * SECOND).astype(np.int64)
    last = np.searchsorted(ns, grid, side="right") - 1
    assert (ns[last] == grid).all()
    found: Rows = {}
    for name in job.watched:
        own = [one for one in names if one == name or one.startswith(f"{name}[")]
        values = [[np.asarray(column(one))[i].item() for one in own] for i in last]
        found[name] = [row if own != [name] else row[0] for row in values]
    return found


def by_simulate(case: Case) -> Rows:
    job = case.job()
    step = job.step_ns / SECOND
    result = simulate(
        job.path, interface_type=case.kind, start_time=0.0, stop_time=job.steps * step,
        step_size=step, output_interval=step, relative_tolerance=case.tolerance,
        inputs=_tracks(case), start_values=case.start_values, output_variables=job.watched,
        event_mode=case.event_mode, in_process=True,
    )  # fmt: skip
    return _columns(job, result.time, list(result.names), result.__getitem__)


def _bench(case: Case, job: Job, record: tuple[str, ...]) -> Bench:
    """A bench with the FMU; what it does by itself is not asked for."""
    bench = Bench(stop_time=job.steps * job.step_ns / SECOND, step=job.step_ns / SECOND,
                  record=record)  # fmt: skip
    more: dict[str, Any] = {"start_values": case.start_values} if case.start_values else {}
    if case.kind != "co-simulation":
        more["interface_type"] = case.kind
    if case.event_mode is not None:
        more["event_mode"] = case.event_mode
    if case.tolerance is not None:
        more["tolerance"] = case.tolerance
    bench.fmu("fmu", job.path, **more)
    return bench


def _run_bench(case: Case, in_process: bool) -> Rows:
    job = case.job()
    bench = _bench(case, job, ("fmu.*",))
    for name, steps in case.inputs.items():
        if any(isinstance(v, str | bytes) or abs(v) > 2**53 for _, v in steps):
            bench.controller(f"source_{name}", _source(steps))
            bench.connect(f"source_{name}.u", f"fmu.{name}")
        else:
            bench.signal(f"source_{name}", Staircase(steps))
            bench.connect(f"source_{name}.value", f"fmu.{name}")
    _trigger(bench, case)
    result = bench.run(in_process=in_process)
    names = [name.removeprefix("fmu.") for name in result.names if name.startswith("fmu.")]
    return _columns(job, result.time, names, lambda name: result[f"fmu.{name}"])


def _trigger(bench: Bench, case: Case) -> None:
    """A clock is triggered where the wire to it carries true."""
    for name, ticks in case.triggers.items():
        bench.controller(f"trigger_{name}", _ticking(ticks))
        bench.connect(f"trigger_{name}.u", f"fmu.{name}")


def _ticking(ticks: tuple[int, ...]) -> Callable[[float], bool]:
    return lambda time: round(time * SECOND) in ticks


def _source(steps: Steps) -> Callable[[float], Any]:
    return lambda time: _at(steps, time)


def by_bench(case: Case) -> Rows:
    return _run_bench(case, in_process=True)


def by_straight_code(case: Case) -> Rows:
    with straight_code():
        return _run_bench(case, in_process=True)


def by_worker(case: Case) -> Rows:
    return _run_bench(case, in_process=False)


def by_wires(case: Case) -> Rows:
    """Sources and a sink of plain Python: what the sink sees is what the wires carry."""
    job = case.job()
    bench = _bench(case, job, ("fmu.*",))
    for name, steps in case.inputs.items():
        bench.controller(f"source_{name}", _source(steps))
        bench.connect(f"source_{name}.u", f"fmu.{name}")
    _trigger(bench, case)
    ends = [(name, end) for name in job.watched for end in _elements(name, case.shape(name))]
    seen: list[tuple[Any, ...]] = []
    bench.controller("sink", _sink(len(ends), seen), outputs=())
    for i, (_, end) in enumerate(ends):
        bench.connect(f"fmu.{end}", f"sink.a{i}", convert_units=False)
    bench.run(in_process=True)
    rows: Rows = {name: [] for name in job.watched}
    for row in seen:
        for name in job.watched:
            own = [value for (array, _), value in zip(ends, row, strict=True) if array == name]
            rows[name].append(own if case.shape(name) else own[0])
    return {name: values + [None] * (job.steps + 1 - len(values)) for name, values in rows.items()}


def _elements(name: str, shape: tuple[int, ...]) -> list[str]:
    if not shape:
        return [name]
    places = itertools.product(*(range(1, 1 + size) for size in shape))
    return [f"{name}[{','.join(map(str, place))}]" for place in places]


def _sink(n: int, seen: list[tuple[Any, ...]]) -> Any:
    def sink(time: float, *values: Any) -> tuple[()]:
        seen.append(values)
        return ()

    names = ["time", *(f"a{i}" for i in range(n))]
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    sink.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(name, kind) for name in names]
    )
    return sink


def by_doctor(case: Case) -> Rows:
    """As the doctor moves an FMU to examine it, with the inputs of the case instead of its own."""
    job = case.job()
    with Fmu(job.path) as fmu:
        subject = Subject(fmu, case.kind, Path(job.path).parent)  # type: ignore[arg-type]
        subject.step = job.step_ns / SECOND
        if case.tolerance is not None:
            subject.settings = replace(subject.settings, relative_tolerance=case.tolerance)
        tracks = _tracks(case)
        triggers = {name: tracks.pop(name) for name in case.triggers}
        trial = Trial(subject, "fmu", case.start_values, triggers)
        trial.inputs = read_inputs(fmu.description, tracks, [])
        rows: Rows = {name: [None] for name in job.watched}
        try:
            trial.begin()
            for k in range(job.steps):
                trial.step(k * subject.step, (k + 1) * subject.step)
                for name, values in rows.items():
                    values.append(np.array(trial.instance.get(name)).ravel().tolist())
                    if not case.shape(name):
                        (values[-1],) = values[-1]
        finally:
            trial.participant.close()
    return rows


def by_plain_driver(case: Case, wired: bool = False) -> Rows:
    return drive(replace(case.job(), wired=wired))


WAYS: dict[str, Callable[[Case], Rows]] = {
    "simulate": by_simulate,
    "bench": by_bench,
    "straight": by_straight_code,
    "worker": by_worker,
    "wires": by_wires,
    "doctor": by_doctor,
}

WIRED = frozenset({"bench", "straight", "worker", "wires"})
"""The ways by which a clock is triggered by a wire: with the inputs, behind the row."""
