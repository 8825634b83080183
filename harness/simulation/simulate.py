"""`simulate`: any FMU in, its trajectory out."""

from __future__ import annotations

import os
import time as wall_clock
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from harness.errors import FmuError, HarnessError, SimulationError
from harness.fmi.fmu import Fmu
from harness.fmi.instance import CO_SIMULATION, FmuInstance
from harness.fmi.logger import LogMessage
from harness.results.manifest import COMPLETE, INCOMPLETE, FmuRecord, Manifest, RunStatus
from harness.simulation.clocks import Clocks, has_input_clocks
from harness.simulation.cosimulation import CoSimulation
from harness.simulation.input_data import InputData, read_inputs
from harness.simulation.model_exchange import ModelExchange
from harness.simulation.outputs import Recorder, Rows, SimulationResult, select
from harness.simulation.settings import Request, Settings, settle
from harness.simulation.start_values import set_start_values

Progress = Callable[[float], None]


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
    progress: Progress | None = None,
    echo: Callable[[LogMessage], None] | None = None,
    on_rows: Callable[[Rows], None] | None = None,
) -> SimulationResult:
    """Simulate one FMU of FMI 1, 2 or 3, in co-simulation or model exchange.

    Times are in seconds; what is None comes from the FMU or is derived, see
    `harness.simulation.settings`. `solver` for model exchange: "cvode", or "euler" with steps of
    `step_size`. `start_values` by name: numbers, arrays, texts, or pairs (value, unit). `inputs`:
    the path of a CSV file, or by name a number, a function of time, or a pair (times, values); see
    `harness.simulation.inputs`. `output_variables`: names, also with * and ?. `event_mode` False
    keeps an FMI 3 FMU that has one in plain co-simulation. `progress` receives the share that is
    done, `echo` each message of the FMU. `on_rows` takes the rows away after every step, so that
    they outlive this process; the result then holds none.

    Raises `UsageError` for what cannot be meant, and otherwise a `HarnessError` whose `result`
    holds the rows recorded before the fault.
    """
    request = Request(
        interface_type, start_time, stop_time, step_size, output_interval, relative_tolerance,
        solver,
    )  # fmt: skip
    with ExitStack() as stack:
        opened = fmu if isinstance(fmu, Fmu) else stack.enter_context(Fmu(Path(fmu)))
        settings = settle(request, opened.description)
        chosen = select(opened.description, output_variables)
        notes = list(settings.notes)
        instance = stack.enter_context(_instance(opened, settings, event_mode, echo, notes))
        stepping = settings.interface_type == CO_SIMULATION
        if stepping and not instance.event_mode and has_input_clocks(opened.description):
            notes.append("the FMU's clocks never tick: co-simulation is done without event mode")
        set_start_values(instance, start_values or {})
        tracks = read_inputs(opened.description, inputs, notes, instance.count)
        clocks = Clocks(instance, settings.start_time, tracks.clocks, notes)
        recorder = Recorder(instance, chosen)
        kind = CoSimulation if settings.interface_type == CO_SIMULATION else ModelExchange
        run = kind(instance, settings, tracks, clocks, recorder, notes)
        return _finish(run.run(), recorder, opened, settings, notes, progress, on_rows)


def _instance(
    fmu: Fmu,
    settings: Settings,
    event_mode: bool | None,
    echo: Callable[[LogMessage], None] | None,
    notes: list[str],
) -> FmuInstance:
    d = fmu.description
    stepping = d.co_simulation if settings.interface_type == CO_SIMULATION else None
    events = stepping is not None and stepping.has_event_mode and event_mode is not False
    early = stepping is not None and stepping.might_return_early

    def made(events: bool) -> FmuInstance:
        return fmu.instantiate(
            d.name, interface_type=settings.interface_type, event_mode=events,
            early_return=events or early, logging=echo is not None, echo=echo,
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
    progress: Progress | None, on_rows: Callable[[Rows], None] | None,
) -> SimulationResult:  # fmt: skip
    began = wall_clock.perf_counter()
    length = settings.stop_time - settings.start_time
    fault: HarnessError | None = None
    try:
        for time in steps:
            if on_rows is not None and recorder.rows.times:
                on_rows(recorder.rows.take())
            if progress is not None and length > 0.0:
                progress((time - settings.start_time) / length)
    except HarnessError as caught:
        fault = caught
    except KeyboardInterrupt:
        until = settings.start_time if recorder.last is None else recorder.last
        fault = SimulationError(f"interrupted after t = {until:.9g} s")
    if on_rows is not None:
        on_rows(recorder.rows.take())
    result = recorder.rows.result(_manifest(fmu, settings, recorder, fault, began), notes)
    if fault is not None:
        fault.result = result
        raise fault
    return result


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
