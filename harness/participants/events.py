"""Event iteration, compiled: for model exchange of FMI 1, 2 and 3, and for event mode of
co-simulation."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from numba import types

from harness.compiler import operations as op
from harness.compiler.calls import (
    call_status,
    load_float64,
    load_int32,
    load_int64,
    load_uint8,
    store_float64,
    store_int64,
)
from harness.compiler.machine_code import cached_callback, compiled
from harness.participants import context as x
from harness.participants.context import failed, get, mark, put, put_real

ENDED = op.ASKED + op.TERMINATED
"""The status of a step in which the FMU asks for the end of the run."""
FULL = op.ASKED + op.FULL
"""The status of a step that cannot go on before rows have been taken away."""
_MOST_ITERATIONS = 1000


@compiled
def hook(c: int, what: int, time: float) -> int:
    """Call Python where it is wanted; 0 where it is not."""
    if get(c, x.WANTED) & what == 0:
        return 0
    return call_status(get(c, x.HOOK), (what, time))


@compiled
def call(c: int, function: int, arguments: Any, what: int, time: float) -> int:
    """Call a function of (instance, *arguments): 0, or the status with which it failed."""
    mark(c, what)
    status = call_status(get(c, function), (get(c, x.HANDLE), *arguments))
    return failed(c, what, status, time) if status > 1 or status < 0 else 0


@compiled
def plain(c: int, function: int, what: int, time: float) -> int:
    """Call a function of the instance alone, where there is one."""
    if get(c, function) == 0:
        return 0
    return call(c, function, (), what, time)


@compiled
def update(c: int, time: float) -> int:
    """One iteration of the discrete states; what it said lies in INFO: five int64 (iterate again,
    end, nominals changed, states changed, next time known), then the next time event (s)."""
    info = get(c, x.INFO)
    raw, version, what = info + 48, get(c, x.VERSION), x.AT_UPDATE
    if version == 3:
        r = raw + 8
        status = call(c, x.UPDATE, (r, r + 1, r + 2, r + 3, r + 4, raw), what, time)
    elif version == 2:
        status = call(c, x.UPDATE, (raw,), what, time)
    else:
        status = call(c, x.UPDATE, (0, raw), what, time)
    if status != 0:
        return status
    for i in range(5):
        if version == 3:
            value = int(load_uint8(raw + 8 + i))
        elif version == 2:
            value = int(load_int32(raw + 4 * i))
        else:  # converged, references of the states, their values, end, next time known
            value = int(load_uint8(raw + i))
        store_int64(info + 8 * i, value)
    if version == 1:
        store_int64(info, 1 - min(1, load_int64(info)))
        nominals, end = load_int64(info + 8), load_int64(info + 24)
        values = load_int64(info + 16)
        store_int64(info + 8, end)
        store_int64(info + 16, nominals)
        store_int64(info + 24, values)
    at = raw if version == 3 else raw + 24 if version == 2 else raw + 8
    store_float64(info + 40, load_float64(at))
    return 0


@compiled
def settle(c: int, time: float) -> int:
    """Iterate the discrete states of an FMU in event mode, and leave it; remembers in INFO whether
    states or nominals have changed."""
    info = get(c, x.INFO)
    nominals, values = 0, 0
    for _ in range(_MOST_ITERATIONS):
        status = hook(c, x.TICK, time)
        if status == 0:
            status = update(c, time)
        if status != 0:
            return status
        nominals |= load_int64(info + 16)
        values |= load_int64(info + 24)
        if load_int64(info + 8) != 0:
            return ENDED
        more = hook(c, x.MORE_TICKS, time)
        if more > 1 or more < 0:
            return more
        if load_int64(info) == 0 and more == 0:
            store_int64(info + 16, nominals)
            store_int64(info + 24, values)
            ahead = load_float64(info + 40) if load_int64(info + 32) != 0 else math.inf
            put_real(c, x.EVENT_TIME, ahead)
            put(c, x.IN_EVENT, 0)
            return plain(c, x.LEAVE_EVENTS, x.AT_LEAVE, time)
    return failed(c, x.UNSETTLED, x.FAULT, time)


@compiled
def full(c: int) -> bool:
    """Whether there is no room for the two rows of an event."""
    return load_int64(get(c, x.ROWS)) + 2 > load_int64(get(c, x.ROOM))


@cache
def settle_entry() -> Any:
    """The C function settle(context, time)."""
    return cached_callback(settle, types.int32(types.int64, types.float64))
