"""Times, steps and tolerances of a simulation: what the user says, else the FMU, else derived.

- start: the default experiment's, else 0
- stop: the default experiment's, else start + 1 s
- communication step: the output interval where that was given (or the FMU's own step, where it
  takes steps of one size only, of which the run needs no more than `MOST_STEPS`), else
  `fixedInternalStepSize`, else the default experiment's step size, else (in scheduled execution)
  the shortest interval of a clock, else derived
- output interval: the default experiment's step size in model exchange; in co-simulation every
  communication point; else derived
- relative tolerance: the default experiment's; the solver for model exchange falls back on 1e-6

Derived means the length of the run over 500, rounded to 1, 2 or 5 times a power of ten. Whatever
was not stated by the user or the FMU is said in `notes`. This module refuses to guess silently.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from harness.errors import UsageError
from harness.fmi.binding.interface import (
    MODEL_EXCHANGE,
    SCHEDULED_EXECUTION,
    InterfaceType,
    capabilities,
)
from harness.fmi.description.model_description import ModelDescription
from harness.participants.clocks import seconds
from harness.participants.grid import exact
from harness.system.policy import SOLVERS, interface

MOST_STEPS = 10_000
_DERIVED_ROWS = 500


@dataclass(frozen=True)
class Request:
    """What the user asked for; None where nothing was said (times in s)."""

    interface_type: str | None = None
    start_time: float | None = None
    stop_time: float | None = None
    step_size: float | None = None
    output_interval: float | None = None
    relative_tolerance: float | None = None
    solver: str = "cvode"


@dataclass(frozen=True)
class Settings:
    """What a simulation goes by (times in s); `step_size` is the communication step; in model
    exchange the largest step of CVODE (None: its own choice), or the step of Euler's method."""

    interface_type: InterfaceType
    start_time: float
    stop_time: float
    step_size: float | None
    output_interval: float | None
    relative_tolerance: float | None
    solver: str = "cvode"
    notes: tuple[str, ...] = ()


def settle(request: Request, d: ModelDescription) -> Settings:
    """The settings for `request`; raises `UsageError` for times that cannot be meant."""
    kind = interface(request.interface_type, d)
    notes: list[str] = []
    start = _first(request.start_time, d.start_time, 0.0) or 0.0
    stop = _first(request.stop_time, d.stop_time)
    if stop is None:
        stop = start + 1.0
        notes.append(f"the FMU names no stop time: it is run until {stop:g} s")
    for what, value in (("start time", start), ("stop time", stop)):
        if not math.isfinite(value):
            raise UsageError(f"the {what} must be finite, not {value} s")
    if stop < start:
        raise UsageError(f"the stop time {stop:g} s lies before the start time {start:g} s")
    for what, value_ in (
        ("step size", request.step_size), ("output interval", request.output_interval),
        ("relative tolerance", request.relative_tolerance),
    ):  # fmt: skip
        if value_ is not None and not (math.isfinite(value_) and value_ > 0.0):
            raise UsageError(f"the {what} must be positive, not {value_}")
    tolerance = _first(request.relative_tolerance, d.tolerance)
    if request.solver not in SOLVERS:
        raise UsageError(f"solver {request.solver!r} is unknown; choose {' or '.join(SOLVERS)}")
    settings = Settings(
        kind, start, stop, request.step_size, request.output_interval, tolerance, request.solver
    )
    finish = _output if kind == MODEL_EXCHANGE else _communication
    return finish(settings, d, notes)


def _communication(s: Settings, d: ModelDescription, notes: list[str]) -> Settings:
    step = s.step_size
    if step is None:
        can = capabilities(d, s.interface_type)
        fixed = can.fixed_internal_step_size
        # its own step is the one that an FMU of one step is sure to take
        own = None if can.can_handle_variable_step else fixed or d.step_size
        own = own if own and (s.stop_time - s.start_time) / own <= MOST_STEPS else None
        step = _first(fixed or None, s.output_interval, d.step_size or None)
        if step is None and s.interface_type == SCHEDULED_EXECUTION:
            step = fastest(d)
        if s.output_interval is not None:
            step = own or _divisor(s.output_interval, fixed)
        if step is None:
            step = derived(s.stop_time - s.start_time)
            notes.append(
                f"the FMU names no step size: {step:g} s was derived from the run's length"
            )
        elif s.output_interval is None:
            step = _coarser(step, s.stop_time - s.start_time, notes)
    elif s.output_interval and exact(s.output_interval) % exact(step):
        notes.append(
            f"outputs are computed every {step:g} s: rows every {s.output_interval:g} s, which is "
            "no multiple of it, repeat the last values in between"
        )
    return replace(s, step_size=step, notes=tuple(notes))


def _divisor(interval: float, fixed: float | None) -> float:
    """The communication step for an output interval: the interval itself, which an FMU with a
    fixed internal step can take where it is a multiple of that, else the internal step."""
    if not fixed or exact(interval) % exact(fixed) == 0:
        return interval
    return min(fixed, interval)


def _coarser(step: float, length: float, notes: list[str]) -> float:
    """A multiple of the FMU's own step that needs at most `MOST_STEPS` steps."""
    if step <= 0.0 or length / step <= MOST_STEPS:
        return step
    factor = 10 ** math.ceil(math.log10(length / step / MOST_STEPS))
    made = float(exact(step) * factor)
    notes.append(
        f"the FMU's step of {step:g} s would need {length / step:.3g} steps: it is asked for "
        f"{made:g} s at a time (say --step-size {step:g} to have all of them)"
    )
    return made


def _output(s: Settings, d: ModelDescription, notes: list[str]) -> Settings:
    interval = _first(s.output_interval, s.step_size, d.step_size or None)
    if interval is None:
        interval = derived(s.stop_time - s.start_time)
        notes.append(f"the FMU names no step size: outputs are recorded every {interval:g} s")
    step = interval if s.solver == "euler" and s.step_size is None else s.step_size
    return replace(s, output_interval=interval, step_size=step, notes=tuple(notes))


def derived(length: float) -> float:
    """About a 500th of `length` (s), as 1, 2 or 5 times a power of ten."""
    if length <= 0.0:
        return 1.0
    wanted = length / _DERIVED_ROWS
    power = math.floor(math.log10(wanted))
    mantissa = wanted / 10.0**power
    round_number = next((m for m in (1, 2, 5) if mantissa <= m * 1.0000001), 10)
    return float(f"{round_number}e{power}")


def fastest(d: ModelDescription) -> float | None:
    """The shortest interval (s) that the file states for an input clock, or None."""
    stated = [v.details.interval for v in d.variables.values() if v.causality == "input"]
    found = [float(interval) for interval in map(seconds, stated) if interval]
    return min((interval for interval in found if interval > 0.0), default=None)


def _first(*values: float | None) -> float | None:
    return next((value for value in values if value is not None), None)
