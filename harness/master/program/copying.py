"""The table of copies: which slot goes to which, by which factor and offset, for COPY and ADD.

A row of a program names a stretch of the table, so all that is copied at once is one operation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.master.plan.actions import Blend, Keep, Slope, Transfer
from harness.master.program import operations as op
from harness.master.program.layout import Layout
from harness.system.graph import Endpoint

Scales = Sequence[tuple[float, float]]


class CopyTable:
    """Grows as rows are asked for; `arrays` are those that the loop takes."""

    def __init__(self, layout: Layout) -> None:
        """An empty table for ports that lie as in `layout`."""
        self.layout = layout
        self._places: list[tuple[int, int]] = []
        self._scales: list[tuple[float, float]] = []

    def arrays(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Source and destination slots (n, 2), factors and offsets (n, 2)."""
        return (
            np.array(self._places, dtype=np.int64).reshape(-1, 2),
            np.array(self._scales, dtype=np.float64).reshape(-1, 2),
        )

    def row(
        self,
        sources: Sequence[int],
        targets: Sequence[int],
        scales: Scales | None = None,
        code: int = op.COPY,
    ) -> list[int]:
        """Copy (or add) slots to slots, by (factor, offset) where they are not (1, 0)."""
        first = len(self._places)
        self._places += zip(sources, targets, strict=True)
        self._scales += [(1.0, 0.0)] * len(sources) if scales is None else scales
        return [code, first, len(self._places)]

    def transfer(self, action: Transfer) -> list[int]:
        """Copy along wires."""
        sources = [self.layout.slot(wire.source, action.view) for wire in action.wires]
        targets = [self.layout.slots[wire.target] for wire in action.wires]
        return self.row(sources, targets, [(wire.factor, wire.offset) for wire in action.wires])

    def keep(self, action: Keep) -> list[int]:
        """Copy present values to previous ones."""
        ends = [Endpoint(action.component, output) for output in action.outputs]
        present = [self.layout.slots[end] for end in ends]
        return self.row(present, [self.layout.slot(end, "previous") for end in ends])

    def weigh(
        self, action: Blend | Slope, into: Sequence[int] | None = None, share: float = 1.0
    ) -> list[list[int]]:
        """`share` times the weighted sum of an action, into slots of its own or its targets."""
        targets = [self.layout.slots[wire.target] for wire in action.wires]
        own, rows = action.own * share, []
        if into is not None or own != 1.0:
            rows.append(self.row(targets, into or targets, [(own, 0.0)] * len(targets)))
        for view, weight in action.terms:
            sources = [self.layout.slot(wire.source, view) for wire in action.wires]
            by = weight * share
            scales = [(by * wire.factor, by * wire.offset) for wire in action.wires]
            rows.append(self.row(sources, into or targets, scales, op.ADD))
        return rows
