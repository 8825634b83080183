"""`simulate`: any FMU in, its trajectory out."""

from __future__ import annotations

import os
import time as wall_clock
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.errors import FmuError, HarnessError, SimulationError, UsageError
from harness.fmi.binding.instance import CO_SIMULATION, FmuInstance
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import apply_start_values, judge_start_values
from harness.process.fork import available
from harness.process.limits import Limits
from harness.results.manifest import COMPLETE, INCOMPLETE, FmuRecord, Manifest, RunStatus
from harness.results.result import Result
from harness.simulation.apart import Ended, Progress, Watched, simulate_apart, simulate_here
from harness.simulation.clocks import Clocks, has_input_clocks
from harness.simulation.cosimulation import CoSimulation
from harness.simulation.input_data import InputData, read_inputs
from harness.simulation.model_exchange import ModelExchange
from harness.simulation.outputs import Recorder, select
from harness.simulation.settings import Request, Settings, settle

_NO_TICKS = "the FMU's clocks never tick: co-simulation is done without event mode"


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
    progress: Progress | None = None,
    echo: Callable[[LogMessage], None] | None = None,
    limits: Limits | None = None,
    in_process: bool | None = None,
) -> Result:
    """Simulate one FMU of FMI 1, 2 or 3, in co-simulation or model exchange.

    Times are in seconds; what is None comes from the FMU or is derived, see
    `harness.simulation.settings`. `solver` for model exchange: "cvode", or "euler" with steps of
    `step_size`. `start_values` by name: numbers, arrays, texts, or pairs (value, unit). `inputs`:
    the path of a CSV file, or by name a number, a function of time, or a pair (times, values); see
    `harness.simulation.inputs`. `output_variables`: names, also with * and ?. `event_mode` False
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
    opened = fmu if isinstance(fmu, Fmu) else None
    path = fmu.path if isinstance(fmu, Fmu) else Path(fmu)
    job = _Job(
        path, opened, request, start_values or {}, inputs, output_variables, event_mode, validate
    )
    if not in_process and available():
        return simulate_apart(
            job.run, path, limits=limits or Limits(), progress=progress, echo=echo
        )
    if limits is not None and limits.isolate:
        raise UsageError("isolation needs a worker process of the run's own, on Linux")
    return simulate_here(job.run, progress=progress, echo=echo)


@dataclass(frozen=True)
class _Job:
    """What is to be simulated: the FMU at `path`, or where it is `opened` already, that."""

    path: Path
    opened: Fmu | None
    request: Request
    start_values: Mapping[str, Any]
    inputs: InputData | None
    output_variables: Sequence[str] | None
    event_mode: bool | None
    validate: bool

    def run(self, watched: Watched) -> Ended:
        """Simulate; faults before the first row are raised, later ones are part of the end."""
        with ExitStack() as stack:
            fmu = self.opened or stack.enter_context(Fmu(self.path, validate=self.validate))
            d = fmu.description
            settings = settle(self.request, d)
            chosen = select(d, self.output_variables)
            judged = judge_start_values(
                d, self.start_values, component=d.name, validate=self.validate
            )
            notes = [*fmu.notes, *settings.notes, *judged.notes]
            instance = stack.enter_context(
                _instance(fmu, settings, self.event_mode, watched, notes)
            )
            stepping = settings.interface_type == CO_SIMULATION
            if stepping and not instance.event_mode and has_input_clocks(d):
                notes.append(_NO_TICKS)
            apply_start_values(instance, judged)
            tracks = read_inputs(instance.description, self.inputs, notes)
            clocks = Clocks(instance, settings.start_time, tracks.clocks, notes)
            recorder = Recorder(instance, chosen)
            kind = CoSimulation if stepping else ModelExchange
            run = kind(instance, settings, tracks, clocks, recorder, notes)
            return _finish(run.run(), recorder, fmu, settings, notes, watched)


def _instance(
    fmu: Fmu,
    settings: Settings,
    event_mode: bool | None,
    watched: Watched,
    notes: list[str],
) -> FmuInstance:
    d = fmu.description
    stepping = d.co_simulation if settings.interface_type == CO_SIMULATION else None
    events = stepping is not None and stepping.has_event_mode and event_mode is not False
    early = stepping is not None and stepping.might_return_early

    def made(events: bool) -> FmuInstance:
        return fmu.instantiate(
            d.name, interface_type=settings.interface_type, event_mode=events,
            early_return=events or early, logging=watched.logging, echo=watched.log,
        )  # fmt: skip

    if not events or event_mode:
        return made(events)
    try:
        return made(True)
    except FmuError as refused:  # some claim an event mode that they do not have
        instance = made(False)
        notes.append(f"co-simulation is done without event mode, since: {refused}")
        return instance


def _finish(
    steps: Any, recorder: Recorder, fmu: Fmu, settings: Settings, notes: list[str],
    watched: Watched,
) -> Ended:  # fmt: skip
    began = wall_clock.perf_counter()
    length = settings.stop_time - settings.start_time
    fault: HarnessError | None = None
    try:
        for time in steps:
            watched.rows(recorder.rows)
            watched.reached(time, (time - settings.start_time) / length if length > 0.0 else 1.0)
    except HarnessError as caught:
        fault = caught
    except KeyboardInterrupt:
        until = settings.start_time if recorder.last is None else recorder.last
        fault = SimulationError(f"interrupted by Ctrl-C at t = {until:.9g} s")
    watched.rows(recorder.rows)
    return fault, _manifest(fmu, settings, recorder, fault, began), tuple(notes)


def _manifest(
    fmu: Fmu, settings: Settings, recorder: Recorder, fault: HarnessError | None, began: float
) -> Manifest:
    until = recorder.last
    status = RunStatus(INCOMPLETE if fault else COMPLETE, until, str(fault or ""))
    experiment = {
        "interface_type": settings.interface_type, "start_time": settings.start_time,
        "stop_time": settings.stop_time, "step_size": settings.step_size,
        "output_interval": settings.output_interval,
        "relative_tolerance": settings.relative_tolerance,
        "solver": settings.solver,
    }  # fmt: skip
    record = FmuRecord(fmu.description.name, fmu.path.name, fmu.sha256)
    wall_time = wall_clock.perf_counter() - began
    return Manifest(status=status, fmus=(record,), experiment=experiment, wall_time=wall_time)
