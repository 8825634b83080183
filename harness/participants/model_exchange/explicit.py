"""Explicit methods for model exchange: Euler's, the classical of order 4, and the pair of Dormand
and Prince of order 5(4) with control of the error.

Euler's and the classical method take steps of one size on a grid and see state events at the end of
a step; they are for real time and for comparison with tools that do the same. The pair locates an
event by shortening the step in which an indicator changed its domain.
"""

from __future__ import annotations

import math

import numpy as np

from harness.compiler.calls import load_float64, load_int64, store_float64
from harness.compiler.machine_code import compiled
from harness.participants import context as x
from harness.participants.context import failed, get, put, put_real, real
from harness.participants.model_exchange.equations import derivatives, indicators

_DORMAND_PRINCE = (
    (),
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
_E = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
"""Dormand and Prince 1980: stages, and the difference of the two solutions."""
_TABLEAUX = {
    x.EULER: ((0.0,), ((), (1.0,))),
    x.RK4: (
        (0.0, 0.5, 0.5, 1.0),
        ((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
    ),
    x.DOPRI5: (
        (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0),
        (*_DORMAND_PRINCE, _DORMAND_PRINCE[-1]),
    ),
}
"""By method: the time of each stage as a share of the step; for each stage, and at last for the
solution, the weights of the derivatives at the stages before."""
STAGES = 7
WORK_VECTORS = STAGES + 2
"""Work space: stages, the states before the step, the states of a stage."""
_HALVINGS = 60

_COUNT = (0, *(len(_TABLEAUX[method][0]) for method in (x.EULER, x.RK4, x.DOPRI5)))
_TIMES, _WEIGHTS = np.zeros((4, STAGES)), np.zeros((4, STAGES + 1, STAGES))
for _method, (_times, _rows) in _TABLEAUX.items():
    _TIMES[_method, : len(_times)] = _times
    for _stage, _row in enumerate(_rows):
        _WEIGHTS[_method, _stage, : len(_row)] = _row


@compiled
def _try(c: int, time: float, h: float, method: int) -> int:
    """From the states before the step to those after it, in X; the stages stay."""
    n = max(1, get(c, x.NX))
    work, states = get(c, x.WORK), get(c, x.X)
    before, stage = work + 8 * n * 7, work + 8 * n * 8
    stages = _COUNT[method]
    for s in range(stages + 1):
        out = stage if s < stages else states
        for i in range(n):
            value = load_float64(before + 8 * i)
            for j in range(s):
                value += h * _WEIGHTS[method, s, j] * load_float64(work + 8 * (n * j + i))
            store_float64(out + 8 * i, value)
        if s < stages:
            status = derivatives(c, time + h * _TIMES[method, s], out, work + 8 * n * s)
            if status != 0:
                return status
    return 0


@compiled
def _error(c: int, h: float) -> float:
    """The estimated error over its tolerance, in the maximum norm."""
    n = get(c, x.NX)
    work, states, absolute = get(c, x.WORK), get(c, x.X), get(c, x.ABSOLUTE)
    before, worst = work + 8 * n * 7, 0.0
    for i in range(n):
        found = 0.0
        for s in range(7):
            found += _E[s] * load_float64(work + 8 * (n * s + i))
        size = max(abs(load_float64(states + 8 * i)), abs(load_float64(before + 8 * i)))
        allowed = load_float64(absolute + 8 * i) + real(c, x.RELATIVE) * size
        worst = max(worst, abs(h * found) / allowed)
    return worst


@compiled
def crossed(c: int, time: float) -> int:
    """Whether an indicator has left its domain at the states X: 0 or 1, -1 where that failed."""
    n = get(c, x.NZ)
    if n == 0:
        return 0
    z, domains = get(c, x.Z), get(c, x.DOMAINS)
    if indicators(c, time, get(c, x.X), z) != 0:
        return -1
    for i in range(n):
        if (load_float64(z + 8 * i) > 0.0) != (load_int64(domains + 8 * i) != 0):
            return 1
    return 0


@compiled
def _size(c: int, time: float, stop: float, method: int) -> float:
    """The end of the next step: on the grid, or as the error allows; never beyond `stop`."""
    if method == x.DOPRI5:
        end = time + real(c, x.STEP_SIZE)
        return stop if end >= stop or stop - end < 1e-3 * (end - time) else end
    first, step = get(c, x.GRID_FIRST), get(c, x.GRID_STEP)
    whole = float(get(c, x.GRID_WHOLE))
    size = step / whole
    k = max(0, math.floor((time - first / whole) / size))
    end = (first + k * step) / whole
    while end <= time + 1e-9 * size:
        k += 1
        end = (first + k * step) / whole
    return stop if end > stop - 1e-9 * size else end


@compiled
def step(c: int, stop: float) -> int:
    """One accepted step from TIME that does not pass `stop`; ROOT says what it met."""
    method, time = get(c, x.METHOD), real(c, x.TIME)
    n = max(1, get(c, x.NX))
    before = get(c, x.WORK) + 8 * n * 7
    for i in range(n):
        store_float64(before + 8 * i, load_float64(get(c, x.X) + 8 * i))
    end = _size(c, time, stop, method)
    while True:
        h = end - time
        if not h > 0.0 or time + 0.5 * h == time:
            return failed(c, x.STALLED, x.FAULT, time)
        status = _try(c, time, h, method)
        if method != x.DOPRI5 or status > 2 or status < 0:
            break
        ratio = 32.0 if status != 0 else _error(c, h) if get(c, x.NX) > 0 else 0.0
        factor = 5.0 if ratio < 1.9e-4 else max(0.2, 0.9 * ratio**-0.2)
        wanted = min(h * factor, real(c, x.LARGEST))
        if ratio <= 1.0:
            if end < stop or wanted > real(c, x.STEP_SIZE):
                put_real(c, x.STEP_SIZE, wanted)
            break
        if not ratio < np.inf:
            wanted = 0.2 * h
        put_real(c, x.STEP_SIZE, wanted)
        end = time + wanted
    if status != 0:
        return status
    found = crossed(c, end)
    if found > 0 and method == x.DOPRI5:
        end = _locate(c, time, end)
        found = 1 if end > 0.0 or end <= 0.0 else -1
    if found < 0:
        return get(c, x.STATUS)
    put(c, x.ROOT, found)
    put_real(c, x.BEFORE_TIME, time)
    put_real(c, x.TIME, end)
    return 0


@compiled
def _locate(c: int, time: float, end: float) -> float:
    """The end of the shortest step, to rounding, at which an indicator has left its domain; NaN
    where an evaluation failed."""
    low, high = time, end
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if _try(c, time, middle - time, x.DOPRI5) != 0:
            return np.nan
        found = crossed(c, middle)
        if found < 0:
            return np.nan
        if found > 0:
            high = middle
        else:
            low = middle
    return high if _try(c, time, high - time, x.DOPRI5) == 0 else np.nan


@compiled
def between(c: int, time: float) -> None:
    """The states at a `time` within the last step, into X_AT: on the line between its ends."""
    n = max(1, get(c, x.NX))
    before, after, out = get(c, x.WORK) + 8 * n * 7, get(c, x.X), get(c, x.X_AT)
    start, end = real(c, x.BEFORE_TIME), real(c, x.TIME)
    share = 1.0 if end <= start else (time - start) / (end - start)
    for i in range(n):
        a, b = load_float64(before + 8 * i), load_float64(after + 8 * i)
        store_float64(out + 8 * i, a + share * (b - a))
