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

from harness.clock import NANOSECONDS
from harness.compiler import operations as op
from harness.compiler.python_call import PythonCall
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
        call = self._bound()
        self.memory.lives.append(call)
        yield [op.CALL_2, call.address, call.context, 0]
        reals = [slot for slot, cell in self._outputs if cell == "real"]
        if reals and len(reals) == len(self._outputs):
            yield [op.CHECK, reals[0], len(reals)]
        else:
            yield from ([op.CHECK, slot, 1] for slot in reals)

    def _bound(self) -> PythonCall:
        """The call for the compiled loop: reals are passed and taken there, all else in Python."""
        memory, inputs, outputs = self.memory, self._inputs, self._outputs
        function, store = self.component.function, self._storing()
        passed = all(cell == "real" for _, cell in inputs)
        taken = len(outputs) == 1 and outputs[0][1] == "real"

        def call(time: float, *given: float) -> Any:
            values = given if passed else [loaded(memory, *place) for place in inputs]
            store(function(time, *values))

        def number(result: Any) -> float:
            return _number(result, self.component.outputs[0].name)

        return PythonCall(
            function if passed and taken else call, self._failed, int(memory.clock.ctypes.data),
            NANOSECONDS, memory.address(inputs[0][0] if inputs else 0),
            len(inputs) if passed else 0, memory.address(outputs[0][0]) if taken and passed else 0,
            number,
        )  # fmt: skip

    def _failed(self, fault: BaseException) -> None:
        self.fault = fault

    def _storing(self) -> Callable[[Any], None]:
        """Where the results go; a sink has no outputs and may return anything."""
        memory, places = self.memory, self._outputs
        names = ", ".join(s.name for s in self.component.outputs)
        if not places:
            return lambda result: None

        def store(result: Any) -> None:
            several = result.ravel() if isinstance(result, np.ndarray) else result
            values = [result] if len(places) == 1 else list(several)
            if len(values) != len(places):
                given = f"returned {len(values)} values for {len(places)} outputs ({names})"
                raise ValueError(given)
            outputs = self.component.outputs
            for value, (slot, cell), signal in zip(values, places, outputs, strict=True):
                if cell == "real":
                    memory.v[slot] = _number(value, signal.name)
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
