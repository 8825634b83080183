"""A plain Python controller called from the compiled loop.

The loop cannot carry a Python exception: it is caught here and kept, the callback returns a
status that ends the run, and whoever runs the loop raises it again with component and time.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.clock import NANOSECONDS
from harness.master.program.operations import INSTANT
from harness.system.graph import PythonComponent

_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int)
_FAILED = 3


class PythonCallback:
    """C callable `int32 f(void)` around `component.function(time, *inputs)`.

    `fault` is the exception that ended the run, or None.
    """

    def __init__(
        self,
        component: PythonComponent,
        clock: NDArray[np.int64],
        inputs: NDArray[np.float64],
        outputs: NDArray[np.float64],
    ) -> None:
        """`clock`, `inputs` and `outputs` are the loop's memory, read and written in place."""
        self.fault: BaseException | None = None
        self._arrays = (clock, inputs, outputs)
        self._function = _PROTOTYPE(self._wrap(component))
        self.address = ctypes.cast(self._function, ctypes.c_void_p).value or 0

    def _wrap(self, component: PythonComponent) -> Any:
        clock, inputs, outputs = (_view(array) for array in self._arrays)
        evaluate = _evaluation(component.function, inputs)
        single = len(component.outputs) == 1
        names = ", ".join(s.name for s in component.outputs)

        def call() -> int:
            try:
                result: Any = evaluate(clock[INSTANT] / NANOSECONDS)
                if single:
                    outputs[0] = result if result.__class__ is float else float(result)
                elif names:  # a sink has no outputs and may return anything
                    _store(outputs, result, names)
            except BaseException as fault:
                self.fault = fault
                return _FAILED
            return 0

        return call


def _view(array: NDArray[Any]) -> Any:
    """The memory of `array`; its items are read and written faster than those of an array."""
    return memoryview(array)  # type: ignore[arg-type]


def _evaluation(function: Callable[..., Any], u: Any) -> Callable[[float], Any]:
    """`function(t, *u)` for one argument t; the usual few inputs without an argument list, which
    costs as much as a small controller."""
    match len(u):
        case 1:
            return lambda t: function(t, u[0])
        case 2:
            return lambda t: function(t, u[0], u[1])
        case 3:
            return lambda t: function(t, u[0], u[1], u[2])
    return lambda t: function(t, *u.tolist())


def _store(outputs: Any, result: Any, names: str) -> None:
    values = [float(value) for value in result]
    if len(values) != len(outputs):
        raise ValueError(f"returned {len(values)} values for {len(outputs)} outputs ({names})")
    for i, value in enumerate(values):
        outputs[i] = value
