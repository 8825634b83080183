"""What the harness asks of a discrete-time block, whoever wrote it.

The contract is structural, so that controllers, estimators and other people's packages need not
import the harness: `step(p, x, u, y)` over flat float64 arrays (parameters, state updated in
place, inputs read at the sample instant, outputs written for it) plus named signals.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
StepFunction = Callable[[Array, Array, Array, Array], None]


@runtime_checkable
class BlockSignal(Protocol):
    """One named scalar at the border of a block."""

    @property
    def name(self) -> str:
        """Unique among the inputs, or outputs, of the block."""

    @property
    def unit(self) -> str:
        """Such as "N"; "1" is dimensionless, "" is not stated and takes that of its neighbour."""

    @property
    def description(self) -> str:
        """One line for people."""

    @property
    def start(self) -> float:
        """What a reader sees before the block has run for the first time."""


@runtime_checkable
class Block(Protocol):
    """A discrete-time block ready to run; see the module docstring."""

    @property
    def inputs(self) -> Sequence[BlockSignal]:
        """In the order of `u`."""

    @property
    def outputs(self) -> Sequence[BlockSignal]:
        """In the order of `y`."""

    @property
    def step(self) -> StepFunction:
        """`step(p, x, u, y)`."""

    @property
    def parameters(self) -> Array:
        """`p`, shape (n_p,)."""

    @property
    def state(self) -> Array:
        """Initial `x`, shape (n_x,)."""


@dataclass(frozen=True)
class Port:
    """A named scalar of a block of the harness itself; unit "" takes that of its neighbour."""

    name: str
    unit: str = ""
    description: str = ""
    start: float = 0.0


@dataclass(frozen=True, eq=False)
class KernelBlock:
    """A block of the harness itself (imperfections, delays); meets `Block`."""

    inputs: tuple[BlockSignal, ...]
    outputs: tuple[BlockSignal, ...]
    step: StepFunction
    parameters: Array = field(default_factory=lambda: np.zeros(0))
    state: Array = field(default_factory=lambda: np.zeros(0))
