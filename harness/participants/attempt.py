"""The usual step of an FMU alone, in compiled code: a snapshot where there can be one, and doStep.

What it comes to, where that is not plain success, is told to Python, which goes on from there: a
step that the FMU discards is divided, and so on. Until steps have their usual length again, Python
takes them all.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import types

from harness.compiler.calls import call_status, integers, octets, reals
from harness.compiler.machine_code import cached_callback
from harness.fmi.binding.instance import FmuInstance
from harness.participants.divided_steps import Stepper

(
    DO_STEP, INSTANCE, USUAL, GET_STATE, PLACE, IS_FMI3, FLAGS, LAST, PYTHON, FREE, SAID,
) = range(11)  # fmt: skip
_NOTHING = -1


class Attempt:
    """Tries the steps of `stepper`; `python` is the address of what does more, as in STEP_CALL.

    `address` and `context` are those of a function for STEP_CALL.
    """

    def __init__(self, instance: FmuInstance, stepper: Stepper, usual: float, python: int) -> None:
        """`usual` is the length of a step (s)."""
        self._instance, self._stepper = instance, stepper
        self._cells = cells = np.zeros(11, dtype=np.int64)
        cells[DO_STEP], cells[INSTANCE] = instance.address("DoStep"), instance.handle or 0
        cells.view(np.float64)[USUAL] = usual
        cells[IS_FMI3], cells[PYTHON] = instance.prefix == "fmi3", python
        self.address, self.context = _code().address, int(cells.ctypes.data)
        self.done()

    def hand_over(self) -> None:
        """The next doStep of the instance is the one that was tried, where there was one."""
        cells = self._cells
        status, cells[SAID] = int(cells[SAID]), _NOTHING
        if status == _NOTHING:
            return
        flags, last = cells[FLAGS : FLAGS + 1].view(np.uint8), cells.view(np.float64)[LAST]

        def again(*arguments: Any) -> int:
            for pointer, flag in zip(arguments[3:6], flags, strict=False):
                pointer.contents.value = bool(flag)
            for pointer in arguments[6:]:
                pointer.contents.value = last
            return status

        self._instance.tried = again

    def done(self) -> None:
        """Python has taken a step."""
        cells, stepper = self._cells, self._stepper
        cells[SAID], cells[FREE] = _NOTHING, stepper.is_free
        cells[PLACE] = stepper.place
        cells[GET_STATE] = 0
        if stepper.place:
            name = "FMUState" if self._instance.prefix == "fmi3" else "FMUstate"
            cells[GET_STATE] = self._instance.address(f"Get{name}")


@cache
def _code() -> Any:
    return cached_callback(attempt, types.int32(types.int64, types.float64, types.float64))


def attempt(context: int, time: float, end: float) -> int:
    """Try to step from `time` to `end` (s); the status."""
    c = integers(context)
    if c[FREE] != 0 and c[SAID] == _NOTHING:
        status = 0
        if c[GET_STATE] != 0:
            status = call_status(c[GET_STATE], (c[INSTANCE], c[PLACE]))
        if status == 0 or status == 1:
            h, usual = end - time, reals(context)[USUAL]
            if abs(h - usual) <= 1e-9 * usual:  # as `is_close` has it
                h = usual
            place, last = context + 8 * FLAGS, context + 8 * LAST
            flags = octets(place)
            c[FLAGS] = 0
            reals(last)[0] = time + h
            if c[IS_FMI3] == 0:
                status = call_status(c[DO_STEP], (c[INSTANCE], time, h, 1))
            else:
                told = (place, place + 1, place + 2, last)
                status = call_status(c[DO_STEP], (c[INSTANCE], time, h, 1, *told))
            if (status == 0 or status == 1) and flags[1] == 0 and flags[2] == 0:
                return 0
            c[SAID] = status
    return call_status(c[PYTHON], (0, time, end))
