"""Linear-quadratic design: the gain, and what shows that it is the right one.

    dx/dt = A·x + B·u,   J = ½∫(xᵀQx + uᵀRu) dt:   u = −K·x,   K = R⁻¹BᵀP
    P·A + Aᵀ·P + Q − P·B·R⁻¹·Bᵀ·P = 0                                   (9), (10) of Takata et al.

    x⁺ = A·x + B·u,      J = ½Σ(xᵀQx + uᵀRu):      u = −K·x,   K = (R + BᵀPB)⁻¹BᵀPA
    AᵀPA − P + Q − AᵀPB·(R + BᵀPB)⁻¹·BᵀPA = 0

Design is separate from running: the record holds the solution, its residual and the poles; a
controller only applies K. States that the input cannot reach are allowed as long as they decay,
as the extra state of an augmented controller does.

This module refuses to know a plant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from controllers.core.block import Array
from controllers.core.errors import ControllerError, require


@dataclass(frozen=True, eq=False)
class LQDesign:
    """An LQ design for n states and r inputs.

    K         gain (r, n) of u = −K·x
    P         solution of the Riccati equation (n, n), symmetric
    residual  largest |element| of the Riccati equation's left side
    poles     of the closed loop (n,), in 1/s, or in z for a discrete design
    """

    K: Array
    P: Array
    residual: float
    poles: NDArray[np.complex128]


def continuous_lq(A: Array, B: Array, Q: Array, R: Array) -> LQDesign:
    """The design for dx/dt = A·x + B·u: A (n, n), B (n, r), Q (n, n) ≥ 0, R (r, r) > 0.

    Raises `ControllerError` for shapes or weights that do not fit, and where no input makes the
    system stable.
    """
    A, B, Q, R = _checked("continuous_lq", A, B, Q, R)
    P = _solved("continuous_lq", linalg.solve_continuous_are, A, B, Q, R)
    K = np.asarray(np.linalg.solve(R, B.T @ P), dtype=np.float64)
    residual = P @ A + A.T @ P + Q - P @ B @ K
    poles = _poles(A - B @ K)
    _require_stable("continuous_lq", float(np.max(poles.real)), poles)
    return LQDesign(K, P, float(np.max(np.abs(residual))), poles)


def discrete_lq(A: Array, B: Array, Q: Array, R: Array) -> LQDesign:
    """The design for x⁺ = A·x + B·u; shapes and faults as in `continuous_lq`."""
    A, B, Q, R = _checked("discrete_lq", A, B, Q, R)
    P = _solved("discrete_lq", linalg.solve_discrete_are, A, B, Q, R)
    K = np.asarray(np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A), dtype=np.float64)
    residual = A.T @ P @ A - P + Q - A.T @ P @ B @ K
    poles = _poles(A - B @ K)
    _require_stable("discrete_lq", float(np.max(np.abs(poles))) - 1.0, poles)
    return LQDesign(K, P, float(np.max(np.abs(residual))), poles)


def _checked(where: str, *given: Array) -> tuple[Array, Array, Array, Array]:
    A, B, Q, R = (np.atleast_2d(np.asarray(matrix, dtype=np.float64)) for matrix in given)
    n, r = len(A), B.shape[1]
    for name, matrix, shape in (("A", A, (n, n)), ("B", B, (n, r)), ("Q", Q, (n, n)),
                                ("R", R, (r, r))):  # fmt: skip
        require(matrix.shape == shape, f"{where}: {name}", f"shape {shape}", matrix.shape)
        require(bool(np.isfinite(matrix).all()), f"{where}: {name}", "finite numbers", matrix)
    for name, matrix in (("Q", Q), ("R", R)):
        require(np.array_equal(matrix, matrix.T), f"{where}: {name}", "a symmetric matrix", matrix)
    lowest = float(np.linalg.eigvalsh(Q)[0])
    legal = lowest >= -1e-12 * float(np.linalg.norm(Q))
    require(legal, f"{where}: Q", "no eigenvalue below 0", lowest)
    lowest = float(np.linalg.eigvalsh(R)[0])
    require(lowest > 0.0, f"{where}: R", "eigenvalues greater than 0", lowest)
    return A, B, Q, R


def _solved(where: str, solve: object, A: Array, B: Array, Q: Array, R: Array) -> Array:
    assert callable(solve)
    try:
        P = np.asarray(solve(A, B, Q, R), dtype=np.float64)
    except np.linalg.LinAlgError as fault:
        raise ControllerError(
            f"{where}: the Riccati equation has no stabilising solution ({fault}); expected an "
            "input that reaches every unstable mode, and a Q that sees it."
        ) from fault
    return 0.5 * (P + P.T)


def _poles(closed_loop: Array) -> NDArray[np.complex128]:
    return np.sort_complex(np.linalg.eigvals(closed_loop).astype(np.complex128))


def _require_stable(where: str, excess: float, poles: NDArray[np.complex128]) -> None:
    require(excess < 0.0, f"{where}: closed loop", "stable poles", poles.tolist())
