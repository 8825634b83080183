"""Luenberger observer: the states of a linear model from what is measured, by a constant gain.

The model dx/dt = A·x + B·u, z = C·x is sampled exactly for a held input. At sample instant k, with
the measurement z_k and the known input u_k:

    x⁻ = Φ·x̂ + Γ·(a·u_k + (1 − a)·u_{k−1})        ν = z_k − C·x⁻        x̂ = x⁻ + L·ν

L places the eigenvalues of (1 − L·C)·Φ, by which the error of x̂ decays, at exp(s_i·T) for the given
poles s_i. Where one quantity is measured there is one such L (Ackermann's formula); where several
are, scipy chooses the one that is least sensitive to the model. The share a is 0 for a command that
the plant obeys at once and 1 for a reading of what acted; a command that arrives late lies between.

The Kalman filter of the same model chooses its gain by the noise instead (`controllers.kalman`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import ControllerError, require, require_finite, require_positive
from controllers.core.layout import Layout, part
from controllers.state_space.discretisation import held

MATRICES = Layout.of(
    Phi=("states", "states"), Gamma=("states", "inputs"), C=("measured", "states"),
    L=("states", "measured"),
)  # fmt: skip
PHI, GAMMA, OUTPUT, GAIN = map(MATRICES.number, MATRICES.names)
HEAD = Layout.of(n=(), m=(), n_u=(), share=(), in_parameters=MATRICES.entries)
N_X, N_Z, N_U, SHARE, IN_PARAMETERS = HEAD.places()

STARTED = 0
N_MEMORY = 1  # then x̂ (n), u_{k−1} (n_u)


def luenberger_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs: z (m), known inputs (n_u); outputs: x̂ (n), ν (m)."""
    n = int(p[N_X])
    m = int(p[N_Z])
    estimate = x[N_MEMORY : N_MEMORY + n]
    before = x[N_MEMORY + n :]
    Phi = part(p[IN_PARAMETERS:], p, PHI)
    Gamma = part(p[IN_PARAMETERS:], p, GAMMA)
    C = part(p[IN_PARAMETERS:], p, OUTPUT)
    L = part(p[IN_PARAMETERS:], p, GAIN)
    for i in range(n):
        y[i] = estimate[i]
    if x[STARTED] > 0.0:
        for i in range(n):
            total = 0.0
            for j in range(n):
                total = total + Phi[i * n + j] * estimate[j]
            for j in range(len(before)):
                acted = p[SHARE] * u[m + j] + (1.0 - p[SHARE]) * before[j]
                total = total + Gamma[i * len(before) + j] * acted
            y[i] = total
    x[STARTED] = 1.0
    for a in range(m):
        expected = 0.0
        for j in range(n):
            expected = expected + C[a * n + j] * y[j]
        y[n + a] = u[a] - expected
    for i in range(n):
        for a in range(m):
            y[i] = y[i] + L[i * m + a] * y[n + a]
        estimate[i] = y[i]
    for j in range(len(before)):
        before[j] = u[m + j]


def observer_gain(Phi: Array, C: Array, eigenvalues: Array) -> Array:
    """L (n, m) that places the eigenvalues of (1 − L·C)·Φ; raises `ControllerError` where the
    model is not observable, or no eigenvalue can be asked for as often."""
    from scipy.signal import place_poles

    n, m = len(Phi), len(C)
    seen = np.vstack([C @ np.linalg.matrix_power(Phi, k + 1) for k in range(n)])
    rank = int(np.linalg.matrix_rank(seen))
    require(rank == n, "Luenberger: A, C", f"an observable model of {n} states", f"{rank} of them")
    if m == 1:
        last = np.linalg.solve(seen, np.eye(n)[:, -1:])
        return np.real(_polynomial(Phi, eigenvalues) @ last)
    try:
        return np.asarray(place_poles(Phi.T, (C @ Phi).T, eigenvalues).gain_matrix.T)
    except ValueError as fault:
        raise ControllerError(f"Luenberger.poles: {fault}") from fault


def _polynomial(Phi: Array, roots: Array) -> Array:
    """Π (Φ − root_i·1)."""
    product = np.eye(len(Phi), dtype=complex)
    for root in roots:
        product = product @ (Phi - root * np.eye(len(Phi)))
    return product


@dataclass(frozen=True, kw_only=True)
class Luenberger:
    """Observer of a linear model by poles.

    A, B, C       the model dx/dt = A·x + B·u, z = C·x: rows of numbers
    poles         s_i [1/s], real numbers or pairs [real part, imaginary part], one for each state
    states, inputs, measured   names; by default x_1, …; u_1, …; z_1, …
    input_delay   how late a command acts, up to a sample [s]; None: at the sample

    The block has the inputs `measured` and `inputs`; its outputs are the states and the innovation
    ν of each measurement.
    """

    A: tuple[tuple[float, ...], ...]
    B: tuple[tuple[float, ...], ...]
    C: tuple[tuple[float, ...], ...]
    poles: tuple[float | tuple[float, float], ...]
    states: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    measured: tuple[str, ...] = ()
    input_delay: float | None = None

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        n = len(self.A)
        for name, columns in (("A", n), ("B", len(self.B[0]) if self.B else 0), ("C", n)):
            matrix = getattr(self, name)
            even = len(matrix) > 0 and all(len(row) == columns for row in matrix)
            require(even, f"Luenberger.{name}", f"rows of {columns} numbers", matrix)
            require_finite(f"Luenberger.{name}", float(np.sum(matrix)))
        require(len(self.B) == n, "Luenberger.B", f"{n} rows, as A has", len(self.B))
        s = self.eigenvalues
        pairs = len(s) == n and np.allclose(np.sort_complex(s), np.sort_complex(s.conj()))
        require(bool(pairs), "Luenberger.poles",
                f"{n} poles, complex ones with their conjugates", self.poles)  # fmt: skip
        sizes = {"states": n, "inputs": len(self.B[0]), "measured": len(self.C)}
        for name, size in sizes.items():
            given = getattr(self, name)
            right = len(given) in (0, size) and len(set(given)) == len(given)
            require(right, f"Luenberger.{name}", f"{size} names", given)

    @property
    def eigenvalues(self) -> Array:
        """The poles as complex numbers, shape (n,)."""
        return np.array([complex(*s) if isinstance(s, tuple | list) else s for s in self.poles])

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("Luenberger.block: sample_time", sample_time)
        delay = sample_time if self.input_delay is None else self.input_delay
        require(0.0 <= delay <= sample_time, "Luenberger.input_delay",
                f"0 to the sample time {sample_time:g} s", delay)  # fmt: skip
        C = np.array(self.C, dtype=np.float64)
        Phi, Gamma = held(np.array(self.A, dtype=float), np.array(self.B, dtype=float), sample_time)
        L = observer_gain(Phi, C, np.exp(self.eigenvalues * sample_time))
        n, m, n_u = len(Phi), len(C), Gamma.shape[1]
        sizes = {"states": n, "inputs": n_u, "measured": m}
        share = 1.0 - delay / sample_time
        table = MATRICES.table(HEAD.length, **sizes)
        head = HEAD.fill({"n": n, "m": m, "n_u": n_u, "share": share, "in_parameters": table})
        p = np.concatenate([head, MATRICES.fill({"Phi": Phi, "Gamma": Gamma, "C": C, "L": L},
                                                **sizes)])  # fmt: skip
        states = _signals(self.states, "x", n, "state")
        measured = _signals(self.measured, "z", m, "measured")
        return Block(
            inputs=(*measured, *_signals(self.inputs, "u", n_u, "known input")),
            outputs=(
                *states,
                *(Signal(f"innovation_{z.name}", "", "measured − predicted") for z in measured),
            ),
            step=luenberger_step,
            parameters=p,
            parameter_names=tuple(f"p_{i}" for i in range(len(p))),
            state=np.zeros(N_MEMORY + n + n_u),
            state_names=tuple(f"memory_{i}" for i in range(N_MEMORY + n + n_u)),
        )


def _signals(names: tuple[str, ...], letter: str, count: int, what: str) -> tuple[Signal, ...]:
    names = names or tuple(f"{letter}_{i}" for i in range(1, count + 1))
    return tuple(Signal(name, "", what) for name in names)
