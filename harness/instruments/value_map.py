"""A table of values on a wire: whole numbers become others, what is not named stays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.errors import ExperimentError
from harness.instruments.checks import is_number, label
from harness.instruments.source import SignalSource
from harness.system.block import Array, KernelBlock, Port


def value_map_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = the second of the pair in p whose first is u; u itself where there is none."""
    y[0] = u[0]
    for i in range(0, p.shape[0], 2):
        if u[0] == p[i]:
            y[0] = p[i + 1]


@dataclass(frozen=True)
class ValueMap:
    """Replaces values as the pairs (from, to) of `table` say, such as codes of a mode."""

    kind: ClassVar[str] = "value_map"
    table: tuple[tuple[float, float], ...]
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks the table."""
        pairs = self.table
        legal = isinstance(pairs, list | tuple) and all(
            isinstance(pair, list | tuple) and len(pair) == 2 and all(map(is_number, pair))
            for pair in pairs
        )
        if not legal:
            raise ExperimentError(
                f"{label(self)}: 'table' must hold pairs of numbers, got {pairs!r}"
            )
        object.__setattr__(self, "table", tuple((float(a), float(b)) for a, b in pairs))
        if len({a for a, _ in self.table}) != len(self.table):
            raise ExperimentError(f"{label(self)}: 'table' maps a value twice: {pairs!r}")

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """The block; `unit` is that of the wire."""
        numbers = np.array([one for pair in self.table for one in pair], dtype=np.float64)
        return KernelBlock(
            inputs=(Port("in", unit, "what the wire carries"),),
            outputs=(Port("out", unit, "what the reader gets"),),
            step=value_map_step,
            parameters=numbers,
        )
