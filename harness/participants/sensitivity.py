"""How much an FMU's output one sample later depends on its input now.

With the input held over a sample h, the linearised FMU  dx/dt = A x + B u,  y = C x + D u  gives

    dy(t + h) / du = C Γ + D,   Γ = ∫₀ʰ exp(A τ) dτ B.

It is exact where that Jacobian holds for the whole sample: at rest and in slow motion, but not in
the middle of a large step, where the plant leaves the state at which it was linearised.

A, B, C and D are the FMU's own directional derivatives at the present state, taken by address in
the loop, one column a call; Γ is the last column of exp([A B; 0 0] h), computed by scaling and
squaring of its Taylor series. States are scaled by their nominal values first, so that hydraulic
pressures and piston positions share one matrix.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from harness.clock import to_seconds
from harness.compiler import operations as op
from harness.compiler.step import compile_step
from harness.errors import FmuError
from harness.participants.fmu import FmuParticipant
from harness.participants.memory import Memory, Row
from harness.participants.participant import Participant
from harness.system.block import Array, KernelBlock, Port
from harness.system.graph import SensitivityComponent

_TERMS = 14  # Taylor terms; with a norm below 1/2 the remainder is below 1e-16


def sampled_sensitivity(p: Array, x: Array, u: Array, y: Array) -> None:
    """y[0] = C Γ + D from one Jacobian.

    p = (n, h, nominal values (n,)); u is the Jacobian of (dx/dt, y) with respect to (x, u),
    shape (n + 1, n + 1), stored by columns; x is work space for three such matrices.
    """
    n, h = int(p[0]), p[1]
    m = n + 1
    matrix = x[: m * m].reshape(m, m)
    power = x[m * m : 2 * m * m].reshape(m, m)
    total = x[2 * m * m : 3 * m * m].reshape(m, m)
    norm = 0.0
    for i in range(m):
        row = 0.0
        for j in range(m):
            scale = h if j == n else h * p[2 + j]
            matrix[i, j] = u[j * m + i] * scale / p[2 + i] if i < n else 0.0
            row += abs(matrix[i, j])
        norm = max(norm, row)
    halvings = 0
    while norm > 0.5 and halvings < 100:
        norm *= 0.5
        halvings += 1
    factor = 0.5**halvings
    for i in range(m):
        for j in range(m):
            matrix[i, j] *= factor
    exponential(matrix, power, total, halvings)
    y[0] = u[n * m + n]
    for j in range(n):
        y[0] += u[j * m + n] * p[2 + j] * total[j, n]


def exponential(matrix: Array, power: Array, total: Array, halvings: int) -> None:
    """total = exp(matrix * 2^halvings) for a matrix (m, m) of norm below 1/2; power is work space.

    Horner's scheme for exp(matrix) - I, then (I + E)^2 - I = 2 E + E E: the small part keeps its
    digits through the squarings. `matrix` is overwritten.
    """
    m = matrix.shape[0]
    for i in range(m):
        for j in range(m):
            total[i, j] = 0.0
    for term in range(_TERMS, 0, -1):
        _extend(matrix, 1.0, matrix, total, float(term), power)
    for _ in range(halvings):
        _extend(total, 2.0, total, total, 1.0, power)


def _extend(
    start: Array, weight: float, left: Array, total: Array, divisor: float, power: Array
) -> None:
    """total <- (weight * start + left total) / divisor, all (m, m); `power` is work space."""
    m = total.shape[0]
    for i in range(m):
        for j in range(m):
            value = weight * start[i, j]
            for k in range(m):
                value += left[i, k] * total[k, j]
            power[i, j] = value / divisor
    for i in range(m):
        for j in range(m):
            total[i, j] = power[i, j]


class SensitivityParticipant(Participant):
    """A sensitivity: one directional derivative a column of the Jacobian, then the block."""

    component: SensitivityComponent

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Find the FMU; raises `FmuError` when it names no states."""
        super().link(memory, participants)
        fmu = participants[self.component.component]
        assert isinstance(fmu, FmuParticipant)
        self.instance = fmu.instance
        d = self.instance.description
        if not d.states:
            raise FmuError(f"sensitivity {self.name}: FMU {d.name} names no continuous states")
        states = [d.variable(name) for name, _ in d.states]
        output, known = d.variable(self.component.output), d.variable(self.component.input)
        unknowns = [*(d.variable(name) for _, name in d.states), output]
        n, h = len(states), to_seconds(self.component.period_ns)
        nominal = [abs(v.nominal or 0.0) or 1.0 for v in states]
        self._unknowns = np.array([v.value_reference for v in unknowns], dtype=np.uint32)
        self._knowns = np.array([v.value_reference for v in [*states, known]], dtype=np.uint32)
        self._seed = np.ones(1)
        self._jacobian = np.zeros((n + 1) ** 2)
        self._parameters = np.array([float(n), h, *nominal])
        self._work = np.zeros(3 * (n + 1) ** 2)
        ports = tuple(Port(f"j{i}") for i in range(self._jacobian.size))
        self._compiled = compile_step(
            KernelBlock(ports, (Port("value"),), sampled_sensitivity, self._parameters, self._work)
        )

    def compute(self) -> Iterator[Row]:
        """One directional derivative a column, then the block."""
        m = self._unknowns.size
        function = self.instance.address("GetDirectionalDerivative")
        handle, seed = self.instance.handle or 0, self._seed.ctypes.data
        for j in range(m):
            known = self._knowns.ctypes.data + 4 * j
            column = self._jacobian.ctypes.data + 8 * m * j
            head = [function, handle, self._unknowns.ctypes.data, m, known, 1, seed]
            if self.instance.prefix == "fmi3":
                yield [op.CALL_9, *head, 1, column, m]
            else:
                yield [op.CALL_7, *head, column]
        p, x, u = (a.ctypes.data for a in (self._parameters, self._work, self._jacobian))
        y = self.memory.address(self.slot("value"))
        yield [op.CALL_5, *self._compiled.call(p, x, u, y)]
