"""Differences of signals, such as an estimation error: first − second, sample by sample.

This module refuses to know what is compared.
"""

from __future__ import annotations

from dataclasses import dataclass

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require


def difference_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = first half of u − second half of u."""
    n = len(y)
    for i in range(n):
        y[i] = u[i] - u[n + i]


@dataclass(frozen=True, kw_only=True)
class Difference:
    """Inputs `first_NAME` and `second_NAME`, outputs `NAME` = first − second.

    names  of the signals
    units  of each, FMI-style strings; left out, not stated
    """

    names: tuple[str, ...]
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        require(len(set(self.names)) == len(self.names) > 0, "Difference.names",
                "one or more different names", self.names)  # fmt: skip
        fits = len(self.units) in (0, len(self.names))
        require(fits, "Difference.units", f"none, or {len(self.names)} units", self.units)

    def block(self, sample_time: float) -> Block:
        """The block; it has no memory, so any sample time [s] will do."""
        units = self.units or ("",) * len(self.names)
        pairs = tuple(zip(self.names, units, strict=True))
        return Block(
            inputs=(
                *(Signal(f"first_{name}", unit) for name, unit in pairs),
                *(Signal(f"second_{name}", unit) for name, unit in pairs),
            ),
            outputs=tuple(Signal(name, unit, "first − second") for name, unit in pairs),
            step=difference_step,
        )
