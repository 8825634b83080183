"""The memory and the operations of a repetition.

The slots of a repetition: its state, the values assumed for the targets of its wires, and those
that the wires have brought; the solver (`fixed_point`) makes the next assumption of both.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.compiler.step import compile_step
from harness.fmi.description.model_description import REAL_TYPES
from harness.master.algorithms.fixed_point import first_sizes, fixed_point_block
from harness.master.plan.actions import Iterate
from harness.system.graph import Descriptions, System
from harness.system.lowering import Wire


class Iteration:
    """A repetition, whose slots are [first, last): state, `assumed` values, `found` values."""

    def __init__(
        self, action: Iterate, system: System, descriptions: Descriptions, first: int
    ) -> None:
        """`first` is the first free slot."""
        n = len(action.wires)
        self.action, self.first, self.last = action, first, first + 1 + 2 * n
        self.assumed = range(first + 1, first + 1 + n)
        self.found = range(first + 1 + n, self.last)
        self.convergence = system.convergence
        self.nominal = [_nominal(wire, descriptions) for wire in action.wires]
        block = fixed_point_block(
            self.nominal, system.convergence.tolerance, system.convergence.max_iterations
        )
        self.parameters, self.work = block.parameters, block.state
        self.compiled = compile_step(block)

    def solve(self, base: int) -> list[int]:
        """The operation that judges a repetition; slot 0 lies at address `base`."""
        arrays = self.parameters.ctypes.data, self.work.ctypes.data
        found, state = base + 8 * self.found[0], base + 8 * self.first
        return [op.CALL_5, *self.compiled.call(*arrays, found, state)]

    def residuals(self, v: NDArray[np.float64]) -> NDArray[np.float64]:
        """|found - assumed| of each wire (n,), relative to its first size; `v` are the slots."""
        size = first_sizes(self.work, len(self.assumed))
        residual = np.abs(v[list(self.found)] - v[list(self.assumed)])
        return np.asarray(residual / np.where(size > 0.0, size, 1.0))


def _nominal(wire: Wire, descriptions: Descriptions) -> float:
    """The size of a signal at its target; 0 where either end is discrete."""
    ends = [descriptions[e.component].port(e.variable)
            for e in (wire.source, wire.target)]  # fmt: skip
    if any(variable.type not in REAL_TYPES for variable in ends):
        return 0.0
    source, target = (abs(variable.nominal or 0.0) for variable in ends)
    return target or source * abs(wire.factor) or 1.0
