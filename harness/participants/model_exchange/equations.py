"""The FMU's equations as the solver sees them: compiled calls of its functions by address.

Statuses are those of FMI. The indicators are given to the solver such that a root is a change of
FMI's domains, z > 0 and z <= 0: where z is not positive, an exact zero counts as a tiny negative
number, so a solver that stops at it or begins there sees the domain that FMI means.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from numba import types

from harness.compiler.calls import call_status, load_float64, load_int64, store_float64
from harness.compiler.machine_code import cached_callback, compiled
from harness.participants import context as x
from harness.participants.context import failed, get
from harness.participants.events import call

_DISCARD = 2
_TINY = 1e-300
_CONTENT_DATA = 16  # bytes into the content of SUNDIALS' serial vectors and dense matrices


@compiled
def vector(c: int, function: int, address: int, n: int, what: int, time: float) -> int:
    """Call a function of (instance, array, size), where the array has elements."""
    return call(c, function, (address, n), what, time) if n > 0 else 0


@compiled
def move(c: int, time: float, states: int) -> int:
    """Set time, states (array at an address) and continuous inputs."""
    status = call(c, x.SET_TIME, (time,), x.AT_SET_TIME, time)
    if status != 0:
        return status
    status = vector(c, x.SET_STATES, states, get(c, x.NX), x.AT_SET_STATES, time)
    if status == 0 and get(c, x.WANTED) & x.APPLY:
        status = call_status(get(c, x.HOOK), (x.APPLY, time))
        if status != 0:
            return failed(c, x.AT_HOOK, status, time)
    return status


@compiled
def derivatives(c: int, time: float, states: int, out: int) -> int:
    """f(t, x) into the array `out`; a state that never moves where there are none."""
    if get(c, x.NX) == 0:
        store_float64(out, 0.0)
        return 0
    status = move(c, time, states)
    if status != 0:
        return status
    return vector(c, x.GET_DERIVATIVES, out, get(c, x.NX), x.AT_DERIVATIVES, time)


@compiled
def indicators(c: int, time: float, states: int, out: int) -> int:
    """g(t, x) into the array `out`, by FMI's domains."""
    status = move(c, time, states)
    if status != 0:
        return status
    n = get(c, x.NZ)
    status = vector(c, x.GET_INDICATORS, out, n, x.AT_INDICATORS, time)
    if status != 0:
        return status
    domains = get(c, x.DOMAINS)
    for i in range(n):
        if load_float64(out + 8 * i) == 0.0 and load_int64(domains + 8 * i) == 0:
            store_float64(out + 8 * i, -_TINY)
    return 0


@compiled
def _answer(status: int) -> int:
    """What CVODE expects: 0, 1 to try a smaller step, -1 to end."""
    if status == 0:
        return 0
    return 1 if status == _DISCARD else -1


@compiled
def _data(thing: int) -> int:
    """Where the numbers of a serial vector or dense matrix of SUNDIALS lie."""
    return load_int64(load_int64(thing) + _CONTENT_DATA)


def _rhs(t: float, y: int, dy: int, c: int) -> int:
    return _answer(derivatives(c, t, _data(y), _data(dy)))


def _roots(t: float, y: int, z: int, c: int) -> int:
    return _answer(indicators(c, t, _data(y), z))


def _jacobian(t: float, y: int, fy: int, matrix: int, c: int, a: int, b: int, d: int) -> int:
    n, status = get(c, x.NX), move(c, t, _data(y))
    rates, states, seed = get(c, x.RATE_REFERENCES), get(c, x.STATE_REFERENCES), get(c, x.SEED)
    function, what = x.DIRECTIONAL, x.AT_DIRECTIONAL
    for j in range(n):
        column, known = _data(matrix) + 8 * n * j, states + 4 * j
        if status == 0 and get(c, x.VERSION) == 3:
            status = call(c, function, (rates, n, known, 1, seed, 1, column, n), what, t)
        elif status == 0:
            status = call(c, function, (rates, n, known, 1, seed, column), what, t)
    return _answer(status)


_I, _F = types.int64, types.float64


@cache
def callbacks() -> tuple[Any, Any, Any]:
    """What CVODE calls: right-hand side, roots, Jacobian, as objects with an `address`."""
    return (
        cached_callback(_rhs, types.int32(_F, _I, _I, _I)),
        cached_callback(_roots, types.int32(_F, _I, _I, _I)),
        cached_callback(_jacobian, types.int32(_F, _I, _I, _I, _I, _I, _I, _I)),
    )
