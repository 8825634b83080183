"""The loop of model exchange, compiled: from one communication point to the next, with all events
on the way.

The solver takes internal steps and never looks beyond the next time event, kink or event that the
hook knows, or the end of the step where inputs may change there. An accepted step is told to the
FMU (completedIntegratorStep) before anything later is asked of it, but after the communication
points that lie within it have been served by the solver's own polynomial. State events are changes
of FMI's domains (`equations`). An event restarts the solver only where states, derivatives, inputs
or nominal values have changed.

What cannot be done here is left to the hook, a callback: inputs that are functions of time, clocks,
rows at events.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from numba import types

from harness.compiler import operations as op
from harness.compiler.calls import (
    call_status,
    load_float64,
    load_int64,
    store_float64,
    store_int64,
)
from harness.compiler.machine_code import cached_callback, compiled
from harness.participants import context as x
from harness.participants.context import failed, get, put, put_real, real
from harness.participants.events import ENDED, FULL, call, full, hook, plain, settle
from harness.participants.model_exchange import explicit
from harness.participants.model_exchange.equations import move, vector

_ONE_STEP, _ROOT_RETURN = 2, 2
_DISCARD = 2
_CLOSE = 2.0**-49  # eight units in the last place
_MOST_EVENTS_AT_ONCE = 1000


@compiled
def domains(c: int, time: float) -> int:
    """Where the indicators are from now on."""
    n = get(c, x.NZ)
    z, found = get(c, x.Z), get(c, x.DOMAINS)
    status = vector(c, x.GET_INDICATORS, z, n, x.AT_INDICATORS, time)
    for i in range(n):
        store_int64(found + 8 * i, 1 if load_float64(z + 8 * i) > 0.0 else 0)
    return status


@compiled
def restart(c: int, time: float) -> int:
    """Begin the solution anew at `time` with the states X."""
    put_real(c, x.TIME, time)
    put_real(c, x.SEGMENT, time)
    if get(c, x.METHOD) != x.CVODE:
        put_real(c, x.BEFORE_TIME, time)
        return 0
    flag = 0
    if get(c, x.NOMINALS_CHANGED) != 0:
        n, nominal = get(c, x.NX), get(c, x.ABSOLUTE)
        if get(c, x.GET_NOMINALS) != 0:
            flag = vector(c, x.GET_NOMINALS, nominal, n, x.AT_NOMINALS, time)
            if flag != 0:
                return flag
        for i in range(n):
            size = abs(load_float64(nominal + 8 * i))
            size = size if 0.0 < size < math.inf else 1.0
            store_float64(nominal + 8 * i, real(c, x.RELATIVE) * size)
        put(c, x.NOMINALS_CHANGED, 0)
    flag = call_status(get(c, x.RESTART), (get(c, x.MEMORY), time, get(c, x.VECTOR)))
    return failed(c, x.AT_SOLVER, flag, time) if flag < 0 else 0


@compiled
def same(a: int, b: int, n: int) -> bool:
    """Whether two arrays hold the same bits."""
    for i in range(n):  # noqa: SIM110
        if load_int64(a + 8 * i) != load_int64(b + 8 * i):
            return False
    return True


@compiled
def event(c: int, time: float) -> int:
    """Handle the event at `time` at which the FMU stands, or at which it is in event mode already
    since an input has jumped."""
    near = abs(time - real(c, x.LAST_EVENT)) <= 4 * _CLOSE * max(abs(time), 1e-300)
    put(c, x.REPEATS, get(c, x.REPEATS) + 1 if near else 0)
    put_real(c, x.LAST_EVENT, time)
    put(c, x.EVENTS, get(c, x.EVENTS) + 1)
    if get(c, x.REPEATS) > _MOST_EVENTS_AT_ONCE:
        return failed(c, x.CHATTERING, x.FAULT, time)
    n, jumped = get(c, x.NX), get(c, x.IN_EVENT) != 0
    before, after = get(c, x.DX_BEFORE), get(c, x.DX)
    status = 0
    if not jumped:
        status = vector(c, x.GET_DERIVATIVES, before, n, x.AT_DERIVATIVES, time)
        if status == 0:
            status = plain(c, x.ENTER_EVENTS, x.AT_ENTER, time)
        put(c, x.IN_EVENT, 1)
    if status == 0:
        status = hook(c, x.APPLY_AT_EVENT, time)
    if status == 0:
        status = settle(c, time)
    if status == 0:
        put_real(c, x.SEGMENT, time)
        status = hook(c, x.PLAN, time)
    if status == 0:
        status = hook(c, x.APPLY, time)
    if status != 0:
        return status
    info = get(c, x.INFO)
    if load_int64(info + 16) != 0:
        put(c, x.NOMINALS_CHANGED, 1)
    changed = jumped or load_int64(info + 16) != 0 or load_int64(info + 24) != 0
    if load_int64(info + 24) != 0:
        status = vector(c, x.GET_STATES, get(c, x.X), n, x.AT_GET_STATES, time)
    if status == 0:
        status = domains(c, time)
    if status == 0 and not changed:
        status = vector(c, x.GET_DERIVATIVES, after, n, x.AT_DERIVATIVES, time)
        changed = not same(before, after, n)
    if status != 0:
        return status
    if not changed:
        put(c, x.UNCHANGED, get(c, x.UNCHANGED) + 1)
        return 0
    return restart(c, time)


@compiled
def finish_step(c: int, target: float) -> int:
    """Tell the FMU of the accepted step that ends at TIME, and handle the event that is due."""
    time = real(c, x.TIME)
    put(c, x.UNFINISHED, 0)
    status = move(c, time, get(c, x.X))
    if status != 0:
        return status
    asked = 0
    if get(c, x.COMPLETED) != 0:
        place = get(c, x.INFO) + 88
        store_int64(place, 0)
        if get(c, x.VERSION) == 1:
            status = call(c, x.COMPLETED, (place,), x.AT_COMPLETED, time)
        else:
            status = call(c, x.COMPLETED, (1, place, place + 4), x.AT_COMPLETED, time)
        if status != 0:
            return status
        word = load_int64(place)
        asked = word & 0xFF
        if get(c, x.VERSION) != 1 and (word >> 32) & 0xFF != 0:
            status = hook(c, x.BEFORE_EVENT, time)
            return status if status != 0 else ENDED
    due = time >= min(real(c, x.EVENT_TIME), real(c, x.HOOK_TIME))
    if time >= real(c, x.KINK_TIME):
        status = hook(c, x.PLAN, time)
    if status == 0 and not due and time == target:
        jumped = hook(c, x.JUMPED, time)
        due = jumped == 1
        status = jumped if jumped > 1 or jumped < 0 else 0
    if status != 0 or (asked == 0 and not due and get(c, x.ROOT) == 0):
        return status
    status = hook(c, x.BEFORE_EVENT, time)
    if status == 0:
        status = event(c, time)
    if status == ENDED or (status == 0 and time < target):
        after = hook(c, x.AFTER_EVENT, time)
        status = after if after != 0 else status
    return status


@compiled
def internal_step(c: int, target: float) -> int:
    """One accepted step of the solver, or the way to a stop that is too near for any."""
    time = real(c, x.TIME)
    stop = min(min(real(c, x.EVENT_TIME), real(c, x.HOOK_TIME)), real(c, x.KINK_TIME))
    stop = min(stop, real(c, x.STOP_TIME) if get(c, x.FREE) != 0 else target)
    stop = max(stop, time + 2.0**-52 * max(abs(time), 1e-300))
    put(c, x.ROOT, 0)
    put(c, x.UNFINISHED, 1)
    close = _CLOSE * max(abs(time), abs(stop))
    if stop - time <= close:
        put_real(c, x.TIME, stop)
        return 0
    if get(c, x.METHOD) != x.CVODE:
        return explicit.step(c, stop)
    memory = get(c, x.MEMORY)
    flag = call_status(get(c, x.SET_STOP), (memory, stop))
    if flag == 0:
        arguments = (memory, stop, get(c, x.VECTOR), get(c, x.TIME_OUT), _ONE_STEP)
        flag = call_status(get(c, x.STEP), arguments)
    if flag < 0:
        return failed(c, x.AT_SOLVER, flag, time) if get(c, x.FAILED) == 0 else flag
    put(c, x.FAILED, 0)  # the solver has found a way around
    reached = load_float64(get(c, x.TIME_OUT))
    put_real(c, x.TIME, stop if abs(reached - stop) <= close else reached)
    put(c, x.ROOT, 1 if flag == _ROOT_RETURN else 0)
    return 0


@compiled
def between(c: int, time: float) -> int:
    """Move the FMU to a `time` within the last step of the solver."""
    if get(c, x.METHOD) == x.CVODE:
        arguments = (get(c, x.MEMORY), time, 0, get(c, x.VECTOR_AT))
        flag = call_status(get(c, x.BETWEEN), arguments)
        if flag < 0:
            return failed(c, x.AT_SOLVER, flag, time)
    else:
        explicit.between(c, time)
    return move(c, time, get(c, x.X_AT))


@compiled
def evaluate(c: int, time: float) -> int:
    """Have the FMU compute at the communication point that it was moved to: local variables of
    OpenModelica's FMUs are those of the last evaluation of the derivatives, be it elsewhere."""
    if get(c, x.IN_EVENT) != 0:
        return 0
    status = vector(c, x.GET_DERIVATIVES, get(c, x.DX), get(c, x.NX), x.AT_DERIVATIVES, time)
    if status == _DISCARD:  # it needs none there
        put(c, x.FAILED, 0)
        return 0
    return status


def advance(c: int, start: float, target: float) -> int:
    """From the communication point `start` to `target` (s); 0, or what `explain` makes words of."""
    status = hook(c, x.BEGIN, start)
    if get(c, x.IN_EVENT) != 0:
        status = event(c, start)
    elif get(c, x.INITIALISING) != 0:  # after a return to a snapshot
        put(c, x.INITIALISING, 0)
        status = restart(c, start)
    while status == 0:
        time = real(c, x.TIME)
        if time <= target and get(c, x.UNFINISHED) != 0:
            if full(c):
                return FULL
            status = finish_step(c, target)
            continue
        if time >= target:
            break
        store_float64(get(c, x.REACHED), time)
        if load_int64(get(c, x.STOP_ASKED)) != 0:
            return failed(c, x.STOPPED, x.FAULT, time)
        status = internal_step(c, target)
    if status == 0 and real(c, x.TIME) > target:
        status = between(c, target)
    if status == 0:
        status = evaluate(c, target)
    store_int64(get(c, x.FUNCTION), 0)
    if status == 0 or status >= op.ASKED:
        return status
    return x.FAULT


def begin_write(w: int, unused: int) -> int:
    """Before inputs are set: whether they have changed, and event mode where they have.

    At address w: the context, how many slots, the addresses of arrays of their addresses and of
    what was set last, whether they have changed (int64 each).
    """
    c, n = load_int64(w), load_int64(w + 8)
    slots, last = load_int64(w + 16), load_int64(w + 24)
    changed = 1 if get(c, x.INITIALISING) != 0 else 0
    for i in range(n):
        bits = load_int64(load_int64(slots + 8 * i))
        if bits != load_int64(last + 8 * i):
            store_int64(last + 8 * i, bits)
            changed = 1
    store_int64(w + 32, changed)
    if changed == 0 or get(c, x.INITIALISING) != 0 or get(c, x.IN_EVENT) != 0:
        return 0
    put(c, x.IN_EVENT, 1)
    return plain(c, x.ENTER_EVENTS, x.AT_ENTER, real(c, x.TIME))


_I, _F = types.int64, types.float64


@cache
def entries() -> tuple[Any, Any]:
    """The C functions advance(context, start, end) and begin_write(place, 0)."""
    return (
        cached_callback(advance, types.int32(_I, _F, _F)),
        cached_callback(begin_write, types.int32(_I, _I)),
    )
