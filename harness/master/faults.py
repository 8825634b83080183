"""What ended a run, in one sentence: which component, which call, which time, and why."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.compiler.operations import INSTANT, OPERATION, RETURNED
from harness.errors import EndRequestedError, HarnessError, SimulationError
from harness.fmi.binding.instance import DISCARD, FATAL
from harness.fmi.binding.logger import status_name
from harness.master.plan.actions import Iterate, Linearise, Step
from harness.master.program.exchange import convert, encode
from harness.master.program.link import Program
from harness.participants.participant import Participant
from harness.participants.python import PythonParticipant


def explain(program: Program, outcome: int) -> HarnessError:
    """The fault behind `outcome` of the loop; an exception of a Python block is its cause.

    What Ctrl-C or `sys.exit` raised inside a Python block is raised again as it is.
    """
    now = int(program.clock[INSTANT])
    action = program.owners[int(program.clock[OPERATION])]
    when = f"at t = {program.plan.lowered.system.seconds(now):.9g} s"
    name = getattr(action, "component", "?")
    if outcome == op.EARLY:
        return SimulationError(
            f"component {name}: {action.call()} {when} returned before the end of the step"
            f"{_got_until(program, now)}, although early return was not allowed at instantiation; "
            "report it to its maker"
        )
    if outcome == op.NOT_CONVERGED:
        return SimulationError(_not_converged(program, when))
    if outcome == op.NOT_FINITE:
        return SimulationError(_not_finite(program, name, when))
    if outcome == op.OUT_OF_RANGE:
        return SimulationError(_out_of_range(program, when))
    status = int(program.clock[RETURNED])
    mover = program.participants.get(name)
    fault = None if mover is None or outcome != op.STATUS else mover.explained(status)
    if mover is not None and fault is not None:
        return _own_fault(program, mover, fault, now, when)
    if isinstance(action, Linearise):
        name = getattr(program.plan.lowered.by_name[name], "component", name)  # its FMU
    instance = program.fmus[name].instance
    if status == FATAL:
        instance.mark_dead()
    if status == DISCARD and isinstance(action, Step) and instance.asks_for_the_end():
        outcome = op.TERMINATED
    if outcome == op.TERMINATED:
        return EndRequestedError(
            f"component {name}: the FMU asked for the end of the run in the step {when}: "
            f"{instance.log.reasons()}"
        )
    label = status_name(status)
    if status == DISCARD:
        label += _got_until(program, now)
    return SimulationError(
        f"component {instance.name}: {action.call()} {when} returned {label}: "
        f"{instance.log.reasons()}"
    )


def _got_until(program: Program, now: int) -> str:
    """What an FMI 3 step that ended early says about the time that it reached, as a phrase.

    FMUs that leave that time alone leave the end of an earlier step there, of which nothing is
    said. After a step that did not end early the standard gives it no meaning.
    """
    row = program.code[int(program.clock[OPERATION])]
    if row[0] != op.STEP_FMI3:
        return ""
    last = ctypes.c_double.from_address(int(row[5])).value
    start, end = map(program.plan.lowered.system.seconds, (now, now + int(row[3])))
    if start < last < end:
        return f" (it got to t = {last:.9g} s)"
    if start <= last <= end or last == op.UNTOUCHED:
        return ""
    return f" (and its lastSuccessfulTime is {last:.9g}, which is not within the step)"


def _not_converged(program: Program, when: str) -> str:
    action = program.owners[int(program.clock[OPERATION])]
    assert isinstance(action, Iterate)
    iteration = program.iterations[action]
    residuals = iteration.residuals(program.v)
    worst = int(np.argmax(residuals))
    wire = action.wires[worst]
    limits = iteration.convergence
    stepping = any(isinstance(inner, Step) for inner in action.body)
    way_out = "take smaller communication steps, " if stepping else ""
    return (
        f"coupling {wire.source} -> {wire.target} {when} did not converge in "
        f"{limits.max_iterations} repetitions: {wire.target} = "
        f"{program.v[iteration.assumed[worst]]:.9g} would have to be "
        f"{program.v[iteration.found[worst]]:.9g} (relative residual {residuals[worst]:.3g}, "
        f"tolerance {limits.tolerance:g}); {way_out}allow more repetitions or a larger tolerance"
    )


def _not_finite(program: Program, name: str, when: str) -> str:
    row = program.code[int(program.clock[OPERATION])]
    checked = row[0] == op.CHECK
    first = row[1] if checked else (row[6] - program.memory.address(0)) // 8
    slot = next(s for s in range(first, first + row[2]) if not np.isfinite(program.v[s]))
    port = next((end for end, place in program.memory.layout.places() if place == slot), name)
    return f"output {port} is {program.v[slot]} {when}; the rows before it are kept"


def _out_of_range(program: Program, when: str) -> str:
    row = program.code[int(program.clock[OPERATION])]
    slot, value = (_converted if row[0] == op.COPY_TYPED else _encoded)(program, row)
    port = next(end for end, place in program.memory.layout.slots.items() if place == slot)
    fmu = program.fmus.get(port.component)
    kind = "a 64-bit integer" if fmu is None else fmu.description.port(port.variable).type
    return (
        f"input {port} of type {kind} cannot hold {value:.17g} {when}; scale or "
        "saturate what is wired to it"
    )


def _encoded(program: Program, row: NDArray[np.int64]) -> tuple[int, float]:
    """The slot that was not to be encoded, and what it holds."""
    _, kind, first, last, *_ = map(int, row)
    room = np.zeros(8, dtype=np.uint8)
    slot = next(s for s in range(first, last) if not encode(kind, program.v, s, s + 1, room, 0))
    return slot, float(program.v[slot])


def _converted(program: Program, row: NDArray[np.int64]) -> tuple[int, float]:
    """The slot into which something was not to be converted, and what that was."""
    v, copies, scales = program.v.copy(), program.copies, program.scales
    i = next(
        i for i in range(int(row[1]), int(row[1] + row[2]))
        if not convert(copies.ravel(), scales.ravel(), v, v.view(np.int64), i, i + 1)
    )  # fmt: skip
    source = int(copies[i, 0])
    whole = copies[i, 2] in (op.FROM_INT64, op.INT64_TO_UINT64)
    value = float(v.view(np.int64)[source]) if whole else float(v[source])
    return int(copies[i, 1]), float(scales[i, 0]) * value + float(scales[i, 1])


def _own_fault(
    program: Program, mover: Participant, fault: BaseException, now: int, when: str
) -> HarnessError:
    """What ended a call of a participant that is not one function of an FMU."""
    if not isinstance(fault, Exception):
        raise fault  # KeyboardInterrupt, SystemExit: no fault of the controller
    if isinstance(fault, HarnessError) and not isinstance(mover, PythonParticipant):
        raise fault
    rate = program.plan.lowered.by_name[mover.name]
    start = program.plan.lowered.system.start_ns
    tick = (now - start - rate.phase_ns) // rate.period_ns
    error = SimulationError(
        f"controller {mover.name} raised {type(fault).__name__}: {fault} {when} (sample {tick})"
    )
    error.__cause__ = fault
    return error
