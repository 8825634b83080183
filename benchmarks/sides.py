"""The sides of the closed-loop benchmark: each runs the same loop and says what a step took.

At each instant: read y, compute u, set it, (record time, y and u), step. Building, loading,
initialising and linking are not counted (`run_overhead` measures them). Processor time counts, not
the clock on the wall, so that a busy machine disturbs less; all sides are single-threaded.
"""

from __future__ import annotations

import ctypes
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from benchmarks.lag import Lag
from benchmarks.pi import STEP, PlainPI, pi_block
from benchmarks.timed_run import timed_run
from harness.bench import Bench

RARELY = 1000
"""Steps between two rows, where rows are not to count."""


@dataclass(frozen=True)
class Measured:
    """Nanoseconds a macro step, and (y, u) at the last instant where the side knows them."""

    nanoseconds: float
    last: tuple[float, float] | None = None


def bare_c(lag: Lag, record: bool, steps: int, loops: int = 1) -> Measured:
    """The C program: dlopen, the same calls, rows in touched memory."""
    command = [str(lag.program(loops)), str(lag.library), str(steps), str(int(record))]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    nanoseconds, y, u = text.split()
    return Measured(float(nanoseconds), (float.fromhex(y), float.fromhex(u)))


def harness_loop(
    lag: Lag, controller: Callable[[], Any], record: bool, steps: int, loops: int = 1
) -> Measured:
    """Our loop through `plan_system` and `execute`, with everything that a run does; a row each
    step, or one in `RARELY`."""
    every = STEP if record else RARELY * STEP
    bench = Bench(stop_time=steps * STEP, step=STEP, record_step=every)
    for i in range(loops):
        bench.fmu(f"plant{i}", lag.fmu)
        bench.controller(f"controller{i}", controller())
        bench.connect(f"plant{i}.y", f"controller{i}.y")
        bench.connect(f"controller{i}.u", f"plant{i}.u")
    run = timed_run(bench.system(), ("plant*.y", "controller*.u"))
    y, u = (float(run.result[f"{name}{loops - 1}.{of}"][-1]) for name, of in _ENDS)
    share = run.nanoseconds if record else run.nanoseconds / RARELY
    return Measured(share, (y, u))


_ENDS = (("plant", "y"), ("controller", "u"))


def compiled(lag: Lag, record: bool, steps: int, loops: int = 1) -> Measured:
    """Our loop with compiled controllers."""
    return harness_loop(lag, pi_block, record, steps, loops)


def plain_python(lag: Lag, steps: int, loops: int = 1) -> Measured:
    """Our loop with plain Python controllers, recorded."""
    return harness_loop(lag, PlainPI, True, steps, loops)


def bare_python_controller(steps: int, loops: int = 1) -> Measured:
    """Nothing but the plain Python controllers, called in a Python loop."""
    controllers = [PlainPI().step for _ in range(loops)]
    step = controllers[0]
    t, y = 0.0, 0.5
    began = time.thread_time()
    if loops == 1:
        for _ in range(steps):
            step(t, y)
    else:
        for _ in range(steps):
            for one in controllers:
                one(t, y)
    return Measured(1e9 * (time.thread_time() - began) / steps)


def _slave(lag: Lag, folder: Path) -> Any:
    description = fmpy.read_model_description(str(folder))
    kind = FMU2Slave if lag.fmi_version == 2 else FMU3Slave
    slave = kind(
        guid=description.guid, unzipDirectory=str(folder), modelIdentifier="lag", instanceName="lag"
    )
    slave.instantiate()
    if lag.fmi_version == 2:
        slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave


def _low_level_calls(slave: Any, preallocated: bool) -> tuple[Callable[[], float], Any, Any]:
    """get y, set u and step, through FMPy's methods or its functions on arrays made once."""
    three = isinstance(slave, FMU3Slave)
    if not preallocated:
        get, set_ = (
            (slave.getFloat64, slave.setFloat64) if three else (slave.getReal, slave.setReal)
        )
        return lambda: get([1])[0], lambda u: set_([0], [u]), slave.doStep
    reference_u, reference_y = (ctypes.c_uint32 * 1)(0), (ctypes.c_uint32 * 1)(1)
    value, c = (ctypes.c_double * 1)(), slave.component
    sizes = (1,) if three else ()
    raw_get, raw_set = (
        (slave.fmi3GetFloat64, slave.fmi3SetFloat64)
        if three
        else (slave.fmi2GetReal, slave.fmi2SetReal)
    )

    def get_y() -> float:
        raw_get(c, reference_y, 1, value, *sizes)
        return value[0]

    def set_u(u: float) -> None:
        value[0] = u
        raw_set(c, reference_u, 1, value, *sizes)

    if not three:
        return get_y, set_u, lambda t, h: slave.fmi2DoStep(c, t, h, 1)
    flags = [ctypes.byref(ctypes.c_bool()) for _ in range(3)]
    last = ctypes.byref(ctypes.c_double())
    return get_y, set_u, lambda t, h: slave.fmi3DoStep(c, t, h, True, *flags, last)


def fmpy_low_level(lag: Lag, folder: Path, preallocated: bool, steps: int) -> Measured:
    """FMPy's FMU2Slave or FMU3Slave in a Python loop, the plain controller, rows in an array."""
    slave = _slave(lag, folder)
    get_y, set_u, do_step = _low_level_calls(slave, preallocated)
    controller = PlainPI().step
    rows = np.zeros((steps + 1, 3))
    began = time.thread_time()
    for k in range(steps + 1):
        t = k * STEP
        y = get_y()
        u = controller(t, y)
        set_u(u)
        rows[k] = t, y, u
        if k < steps:
            do_step(t, STEP)
    seconds = time.thread_time() - began
    slave.terminate()
    slave.freeInstance()
    return Measured(1e9 * seconds / steps, (rows[-1, 1], rows[-1, 2]))


def fmpy_simulate(lag: Lag, folder: Path, steps: int) -> Measured:
    """FMPy's simulate_fmu, the loop closed in its callback `step_finished`."""
    description = fmpy.read_model_description(str(folder))
    controller = PlainPI()
    setter = "setReal" if lag.fmi_version == 2 else "setFloat64"
    u = controller.step(0.0, 0.0)

    def step_finished(t: float, recorder: Any) -> bool:
        nonlocal u
        u = controller.step(t, recorder.rows[-1][1])
        getattr(recorder.fmu, setter)([0], [u])
        return True

    began = time.thread_time()
    result = fmpy.simulate_fmu(
        str(folder), model_description=description, stop_time=steps * STEP, output_interval=STEP,
        start_values={"u": u}, output=["y"], step_finished=step_finished,
    )  # fmt: skip
    seconds = time.thread_time() - began
    return Measured(1e9 * seconds / steps, (float(result["y"][-1]), u))
