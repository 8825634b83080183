"""What compiled code knows of one FMU with events: an array of 8-byte cells at an address.

Whole numbers and addresses are int64, times float64. Python fills it before the first step; from
then on the kernels read and write it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.calls import load_float64, load_int64, store_float64, store_int64
from harness.compiler.machine_code import compiled

(
    HANDLE, VERSION, NX, NZ,
    SET_TIME, SET_STATES, GET_STATES, GET_DERIVATIVES, GET_INDICATORS, GET_NOMINALS,
    COMPLETED, ENTER_EVENTS, UPDATE, LEAVE_EVENTS, DIRECTIONAL,
) = range(15)  # fmt: skip
"""The instance, the version of FMI, how many states and indicators; addresses of its functions, 0
for what is not called."""

(
    X, X_AT, DX, DX_BEFORE, Z, DOMAINS, INFO, STATE_REFERENCES, RATE_REFERENCES, SEED,
) = range(15, 25)  # fmt: skip
"""Addresses of arrays: states of the solver, states between its steps, derivatives after and before
an event, indicators, whether each is positive, what event functions write, and what directional
derivatives take."""

(
    METHOD, MEMORY, VECTOR, VECTOR_AT, STEP, SET_STOP, RESTART, BETWEEN, TOLERANCES, ABSOLUTE,
    TIME_OUT, WORK, GRID_FIRST, GRID_STEP, GRID_WHOLE,
) = range(25, 40)  # fmt: skip
"""The method, CVODE's objects and functions; for explicit methods work space, and the grid of their
steps, (first + k step) / whole in s."""

(
    HOOK, WANTED, FREE, IN_EVENT, UNFINISHED, ROOT, ASKED_EVENT, REPEATS, UNCHANGED, EVENTS,
    REACHED, STOP_ASKED, INITIALISING, NOMINALS_CHANGED, ROWS, ROOM, FUNCTION,
) = range(40, 57)  # fmt: skip
"""The callback and what it is wanted for; whether the solver may pass the end of a step; whether
the FMU is in event mode; whether an accepted step is still to be told, and whether an indicator
changed its domain there; counters of events; where to tell the time, and where to look whether to
end; where the number of rows stands, how many there is room for, and where to tell the call."""

(FAILED, STATUS) = range(57, 59)
"""The call that failed, and what it returned."""

(
    TIME, SEGMENT, EVENT_TIME, HOOK_TIME, KINK_TIME, STOP_TIME, LAST_EVENT, RELATIVE, LARGEST,
    FAILED_AT, STEP_SIZE, BEFORE_TIME,
) = range(59, 71)  # fmt: skip
"""Times (s): of the solver, where inputs changed last, of the next time event, of the next event
and the next kink that the hook knows, of the stop, of the last event; tolerance; times of a fault
and of the last step of an explicit method."""

SIZE = 71

APPLY, APPLY_AT_EVENT, TICK, MORE_TICKS, PLAN, BEFORE_EVENT, AFTER_EVENT, JUMPED, BEGIN = (
    1 << i for i in range(9)
)
"""What the hook may be wanted for: to set continuous inputs, all inputs; to set the clocks that
tick and say whether more do; to look ahead; to record both sides of an event; to say whether an
input has jumped; to be told that a step begins."""

CVODE, EULER, RK4, DOPRI5 = range(4)

(
    NOTHING, AT_SET_TIME, AT_SET_STATES, AT_GET_STATES, AT_DERIVATIVES, AT_INDICATORS,
    AT_NOMINALS, AT_COMPLETED, AT_ENTER, AT_UPDATE, AT_LEAVE, AT_HOOK, AT_SOLVER, UNSETTLED,
    CHATTERING, STOPPED, AT_DIRECTIONAL, STALLED,
) = range(18)  # fmt: skip
"""Calls that may fail, and other reasons to end."""

FAULT = 3
"""The status of what Python explains by `FAILED`."""


class Context:
    """The array as Python sees it; `address` goes to compiled code."""

    def __init__(self) -> None:
        self.cells: NDArray[np.int64] = np.zeros(SIZE, dtype=np.int64)
        self.reals = self.cells.view(np.float64)
        self.address = int(self.cells.ctypes.data)
        self._arrays: list[NDArray[Any]] = []

    def array(self, place: int, values: NDArray[Any]) -> NDArray[Any]:
        """Put the address of an array that lives as long as this one."""
        self._arrays.append(values)
        self.cells[place] = values.ctypes.data
        return values


@compiled
def get(c: int, place: int) -> int:
    """A whole number of the context at address c."""
    return load_int64(c + 8 * place)


@compiled
def put(c: int, place: int, value: int) -> None:
    """Change a whole number."""
    store_int64(c + 8 * place, value)


@compiled
def real(c: int, place: int) -> float:
    """A real number of the context."""
    return load_float64(c + 8 * place)


@compiled
def put_real(c: int, place: int, value: float) -> None:
    """Change a real number."""
    store_float64(c + 8 * place, value)


@compiled
def failed(c: int, what: int, status: int, time: float) -> int:
    """Remember what failed; its status."""
    put(c, FAILED, what)
    put(c, STATUS, status)
    put_real(c, FAILED_AT, time)
    return status


@compiled
def mark(c: int, what: int) -> None:
    """Tell which call of the FMU is under way: its number and 32 times the version of FMI."""
    store_int64(get(c, FUNCTION), what + 32 * get(c, VERSION))
