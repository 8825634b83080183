"""`simulate`: any FMU in, its trajectory out. It is the run of a system of one."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.clock import NANOSECONDS
from harness.errors import HarnessError, SimulationError, UsageError
from harness.fmi.binding.interface import CO_SIMULATION, MODEL_EXCHANGE
from harness.fmi.binding.logger import LogMessage
from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import judge_start_values
from harness.master.prepared import PreparedSystem
from harness.master.recorded import select
from harness.participants.grid import exact
from harness.participants.settings import Request, Settings, settle
from harness.participants.track_data import InputData, read_inputs
from harness.process.fork import available
from harness.process.limits import Limits
from harness.process.run import run_supervised
from harness.results.columns import TIME, bare_name
from harness.results.result import Result
from harness.system.graph import Endpoint, FmuComponent, System
from harness.system.policy import Policy

_LARGEST = 2**62


def simulate(
    fmu: str | os.PathLike[str] | Fmu,
    *,
    interface_type: str | None = None,
    start_time: float | None = None,
    stop_time: float | None = None,
    step_size: float | None = None,
    output_interval: float | None = None,
    relative_tolerance: float | None = None,
    solver: str = "cvode",
    start_values: Mapping[str, Any] | None = None,
    inputs: InputData | None = None,
    output_variables: Sequence[str] | None = None,
    event_mode: bool | None = None,
    validate: bool = True,
    progress: Callable[[float], None] | None = None,
    echo: Callable[[LogMessage], None] | None = None,
    limits: Limits | None = None,
    in_process: bool | None = None,
) -> Result:
    """Simulate one FMU of FMI 1, 2 or 3, in any kind of interface.

    Times are in seconds; what is None comes from the FMU or is derived, see
    `harness.participants.settings`; how the FMU is run is said in `harness.system.policy`.
    `solver` for model exchange: "cvode", or an explicit method with steps of `step_size`.
    `start_values` by name: numbers, arrays, texts, or pairs (value, unit). `inputs`: the path of a
    CSV file, or by name a number, a function of time, or a pair (times, values); see
    `harness.participants.tracks`. `output_variables`: names, also with * and ?. `event_mode` False
    keeps an FMI 3 FMU that has one in plain co-simulation. Without `validate`, faults of the model
    description that do not stop the simulation become notes. `progress` receives the share that
    is done, `echo` each message of the FMU.

    The FMU runs in a worker process within `limits`, so that one that crashes, hangs or exits ends
    the simulation and not the caller; functions as inputs are called there too. With `in_process`
    true all of it happens in this process.

    Raises `UsageError` for what cannot be meant, and otherwise a `HarnessError` whose `result`
    holds the rows recorded before the fault.
    """
    request = Request(
        interface_type, start_time, stop_time, step_size, output_interval, relative_tolerance,
        solver,
    )  # fmt: skip
    supervised = not in_process and available()
    if not supervised and limits is not None and limits.isolate:
        raise UsageError("isolation needs a worker process of the run's own, on Linux")
    with ExitStack() as stack:
        opened = (
            fmu if isinstance(fmu, Fmu) else stack.enter_context(Fmu(Path(fmu), validate=validate))
        )
        d = opened.description
        settings = settle(request, d)
        chosen = tuple(Endpoint(d.name, v.name) for v in select(d, output_variables))
        notes = [*settings.notes]
        notes += [
            f"the variable 'time' was recorded as {bare_name(d.name, end.variable)!r}"
            for end in chosen
            if end.variable == TIME
        ]
        given = start_values or {}
        judged = judge_start_values(d, given, component=d.name, validate=validate)
        read_inputs(d.configured(judged.structural), inputs, [])  # faults before anything is run
        largest = settings.step_size if settings.interface_type == MODEL_EXCHANGE else None
        policy = Policy(
            interface_type=settings.interface_type, tolerance=settings.relative_tolerance,
            solver=solver, largest_step=largest, event_mode=event_mode,
            discarded_steps="divide", validate=validate, allow_not_finite=True,
        )  # fmt: skip
        component = FmuComponent(d.name, opened.path, 1, given, policy, inputs)
        system = _system(component, d, settings, notes)
        told = None if echo is None else (lambda _, message: echo(message))
        stated = {key: value for key, value in vars(settings).items() if key != "notes"}
        common: dict[str, Any] = {"progress": progress, "echo": told, "experiment": stated}
        try:
            if supervised:
                result = run_supervised(system, record=chosen, limits=limits, **common)
            else:
                with PreparedSystem(system, chosen) as prepared:
                    result = prepared.run(**common)
        except HarnessError as fault:
            if isinstance(fault.result, Result):
                fault.result = _noted(fault.result, notes)
            raise
        except KeyboardInterrupt as interrupt:
            raise _interrupted(interrupt, notes) from interrupt
    return _noted(result, notes)


def _interrupted(interrupt: KeyboardInterrupt, notes: Sequence[str]) -> SimulationError:
    """The fault of a simulation that Ctrl-C ended, with its rows."""
    result: Result | None = getattr(interrupt, "result", None)
    until = None if result is None or not len(result.time) else float(result.time[-1])
    said = str(interrupt)
    if " at t = " not in said:
        where = "before its first row" if until is None else f"at t = {until:.9g} s"
        said = f"{said or 'interrupted by Ctrl-C'} {where}"
    fault = SimulationError(said)
    fault.result = None if result is None else _noted(result, notes)
    return fault


def _noted(result: Result, notes: Sequence[str]) -> Result:
    return replace(result, notes=(*notes, *result.manifest.notes))


def _system(component: FmuComponent, d: ModelDescription, s: Settings, notes: list[str]) -> System:
    """The system of one: communication points are those of the step, of the rows, of events."""
    step = s.output_interval if s.interface_type == MODEL_EXCHANGE else s.step_size
    assert step is not None
    interval = s.output_interval or step
    whole = _ticks(s, step, interval)

    def ticks(seconds: float) -> int:
        return round(exact(seconds) * whole)

    start, stop, step_ticks, record = map(ticks, (s.start_time, s.stop_time, step, interval))
    can = d.co_simulation if s.interface_type == CO_SIMULATION else None
    if can is not None and not can.can_handle_variable_step:  # rows are where steps end
        record = math.lcm(step_ticks, record)
        if (stop - start) % step_ticks:
            end = (start + (stop - start) // step_ticks * step_ticks) / whole
            notes.append(
                f"the run ends at t = {end:.9g} s: the FMU takes no steps but those of {step:g} s, "
                "and the next one would pass the stop time"
            )
    return System(
        (replace(component, step_ns=step_ticks),), (), start, stop, record,
        ticks_per_second=whole, single=True,
    )  # fmt: skip


def _ticks(s: Settings, step: float, interval: float) -> int:
    """Ticks in a second, such that all times are whole ones; where they would not fit, the stop
    time is the nearest one."""
    times = [exact(t) for t in (s.start_time, step, interval)]
    whole = math.lcm(NANOSECONDS, *(t.denominator for t in times))
    finer = math.lcm(whole, exact(s.stop_time).denominator)
    longest = max(abs(s.start_time), abs(s.stop_time), step, interval)
    return finer if finer * longest < _LARGEST and finer < _LARGEST else whole
