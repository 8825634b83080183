"""A plain Python controller called from the compiled loop.

The loop cannot carry a Python exception: it is caught here and remembered, the callback returns a
status that ends the run, and whoever runs the loop raises it again with component and time.

Inputs and outputs are numbers, or what they are wired to: whole numbers of 64 bits as int, strings
and binaries as str and bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.clock import NANOSECONDS
from harness.compiler import operations as op
from harness.compiler.operations import INSTANT
from harness.participants.context import FAULT
from harness.participants.memory import Cell, Memory, Row, loaded, raw
from harness.participants.participant import Participant
from harness.system.block import BlockSignal
from harness.system.graph import Endpoint, PythonComponent


class PythonParticipant(Participant):
    """`component.function(time, *inputs)`; `fault` is the exception that ended the run, or None."""

    component: PythonComponent

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Find where inputs and outputs lie."""
        super().link(memory, participants)
        self._inputs = self._places(self.component.inputs)
        self._outputs = self._places(self.component.outputs)

    def _places(self, signals: Sequence[BlockSignal]) -> list[tuple[int, Cell]]:
        ends = [Endpoint(self.name, signal.name) for signal in signals]
        return [(self.memory.slot(end), self.memory.cell(end)) for end in ends]

    def compute(self) -> Iterator[Row]:
        """Call it, and look whether what it gave is finite."""
        yield [op.CALL_4, self.memory.function(self._wrap()), 0, 0, 0, 0]
        reals = [slot for slot, cell in self._outputs if cell == "real"]
        if reals and len(reals) == len(self._outputs):
            yield [op.CHECK, reals[0], len(reals)]
        else:
            yield from ([op.CHECK, slot, 1] for slot in reals)

    def _wrap(self) -> Callable[[], int]:
        """What C calls as `int32 f(void)`."""
        clock: Any = _view(self.memory.clock)
        evaluate = self._evaluation(self.component.function)
        store = self._storing()

        def call() -> int:
            try:
                store(evaluate(clock[INSTANT] / NANOSECONDS))
            except BaseException as fault:
                self.fault = fault
                return FAULT
            return 0

        return call

    def _evaluation(self, function: Callable[..., Any]) -> Callable[[float], Any]:
        """`function(t, *u)` for one argument t; the usual few real inputs without an argument
        list, which costs as much as a small controller."""
        memory, places = self.memory, self._inputs
        if any(cell != "real" for _, cell in places):
            return lambda t: function(t, *(loaded(memory, *place) for place in places))
        first = places[0][0] if places else 0
        u = _view(memory.v[first : first + len(places)])
        match len(places):
            case 1:
                return lambda t: function(t, u[0])
            case 2:
                return lambda t: function(t, u[0], u[1])
            case 3:
                return lambda t: function(t, u[0], u[1], u[2])
        return lambda t: function(t, *u.tolist())

    def _storing(self) -> Callable[[Any], None]:
        """Where the results go; a sink has no outputs and may return anything."""
        memory, places = self.memory, self._outputs
        names = ", ".join(s.name for s in self.component.outputs)
        if not places:
            return lambda result: None
        first = places[0][0]
        y = _view(memory.v[first : first + len(places)])
        if len(places) == 1 and places[0][1] == "real":

            def store_one(result: Any) -> None:
                y[0] = result if result.__class__ is float else _number(result, names)

            return store_one

        def store(result: Any) -> None:
            several = result.ravel() if isinstance(result, np.ndarray) else result
            values = [result] if len(places) == 1 else list(several)
            if len(values) != len(places):
                given = f"returned {len(values)} values for {len(places)} outputs ({names})"
                raise ValueError(given)
            outputs = self.component.outputs
            for value, (slot, cell), signal in zip(values, places, outputs, strict=True):
                if cell == "real":
                    y[slot - first] = _number(value, signal.name)
                else:
                    memory.wide[slot] = raw(value, cell, memory.texts)

        return store


def _number(result: Any, name: str) -> float:
    """A result as a float, also an array of one element, as `-K @ x` is."""
    try:
        if isinstance(result, np.ndarray) and result.size == 1:
            return float(result.item())
        return float(result)
    except (TypeError, ValueError):
        shape = f" of shape {result.shape}" if isinstance(result, np.ndarray) else ""
        raise ValueError(
            f"returned {type(result).__name__}{shape} for output {name}, which takes one number"
        ) from None


def _view(array: NDArray[Any]) -> Any:
    """The memory of `array`; its items are read and written faster than those of an array."""
    return memoryview(array)  # type: ignore[arg-type]
