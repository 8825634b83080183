"""The two-mass drive as its controllers and estimators know it: model functions and (5)–(8).

Serkies & Szabat 2013, per-unit quantities, torque loop neglected:

    T_1 dω_1/dt = m_e − m_s,   T_2 dω_2/dt = m_s − m_L,   T_c dm_s/dt = ω_1 − ω_2        (1)–(3)

State of the estimators: (ω_1, ω_2, m_s, m_L), the load torque constant but for its noise; input
m_e; measurement ω_1. Closed loop of (4), u = k_I·∫(ω_ref − ω_2) dt − k_1·ω_1 − k_2·m_s − k_3·ω_2:

    ω_2/ω_ref = ω_r⁴/(s² + 2ξω_r·s + ω_r²)²

    k_I = T_1·T_2·T_c·ω_r⁴                                                                   (5)
    k_1 = 4·T_1·ξ·ω_r                                                                        (6)
    k_2 = T_1·T_c·(2ω_r² + 4ξ²ω_r² − 1/(T_2·T_c) − 1/(T_1·T_c))                              (7)
    k_3 = k_1·(ω_r²·T_2·T_c − 1)                                                             (8)

(7) and (8) are printed with T_1·T_2 in the places of T_1·T_c and T_2·T_c; so they place no poles.
`two_mass_gains` and `two_mass_transition` are the functions that the general steps are bound to.
"""

from __future__ import annotations

import numpy as np

from controllers.core.block import Array
from controllers.state_space.discretisation import hold, hold_work
from controllers.state_space.pole_placement import PolePlacement, design_of, with_integral

# Parameters of the gains and of the model, in their arrays.
G_T1, G_TC, G_OMEGA, G_XI = range(4)
M_T1, M_TC, M_TS = range(3)

N, N_U, N_Z = 4, 1, 1
TRANSITION_WORK = N * N + N * N_U + N * N_U + hold_work(N, N_U)


def two_mass_gains(p: Array, s: Array, k: Array) -> None:
    """k = (k_I, k_1, k_2, k_3) by (5)–(8) for p = (T_1, T_c, ω_r, ξ) and s = (T_2,).

    Until T_2 is known (0, as masters that step all at once begin) the load weighs as the motor."""
    T1 = p[G_T1]
    Tc = p[G_TC]
    T2 = s[0] if s[0] > 0.0 else T1
    square = p[G_OMEGA] * p[G_OMEGA]
    k[0] = T1 * T2 * Tc * square * square
    k[1] = 4.0 * T1 * p[G_XI] * p[G_OMEGA]
    damping = 4.0 * p[G_XI] * p[G_XI] * square
    k[2] = T1 * Tc * (2.0 * square + damping - 1.0 / (T2 * Tc) - 1.0 / (T1 * Tc))
    k[3] = k[1] * (square * T2 * Tc - 1.0)


def two_mass_gains_as_printed(p: Array, s: Array, k: Array) -> None:
    """(5)–(8) with the misprints of (7) and (8), to show what they do."""
    T1 = p[G_T1]
    Tc = p[G_TC]
    T2 = s[0] if s[0] > 0.0 else T1
    square = p[G_OMEGA] * p[G_OMEGA]
    two_mass_gains(p, s, k)
    k[2] = k[2] * T2 / Tc
    k[3] = k[1] * (square * T1 * T2 - 1.0)


def two_mass_matrices(T1: float, T2: float, Tc: float, A: Array, B: Array) -> None:
    """A (16,) and B (4,) of the state (ω_1, ω_2, m_s, m_L) and the input m_e."""
    for i in range(N * N):
        A[i] = 0.0
    for i in range(N):
        B[i] = 0.0
    A[2] = -1.0 / T1
    A[N + 2] = 1.0 / T2
    A[N + 3] = -1.0 / T2
    A[2 * N] = 1.0 / Tc
    A[2 * N + 1] = -1.0 / Tc
    B[0] = 1.0 / T1


def two_mass_transition(
    p: Array, s: Array, x: Array, u: Array, following: Array, F: Array, work: Array
) -> None:
    """State one sample later and its Jacobian F (16,), exact for a held torque; p is
    (T_1, T_c, T_s), s is (T_2,), work of length TRANSITION_WORK."""
    A = work[: N * N]
    B = work[N * N : N * N + N]
    Gamma = work[N * N + N : N * N + 2 * N]
    T2 = s[0] if s[0] > 0.0 else p[M_T1]
    two_mass_matrices(p[M_T1], T2, p[M_TC], A, B)
    hold(N, N_U, A, B, p[M_TS], F, Gamma, work[N * N + 2 * N :])
    for i in range(N):
        total = Gamma[i] * u[0]
        for j in range(N):
            total = total + F[i * N + j] * x[j]
        following[i] = total


def two_mass_measurement(p: Array, s: Array, x: Array, z: Array, H: Array) -> None:
    """z = ω_1 and its Jacobian H = (1, 0, 0, 0)."""
    z[0] = x[0]
    H[0] = 1.0
    for i in range(1, N):
        H[i] = 0.0


def drive_model(T1: float, T2: float, Tc: float) -> tuple[Array, Array]:
    """A (4, 4) and B (4, 1) as numpy arrays, for design and offline use."""
    A, B = np.empty(N * N), np.empty(N)
    two_mass_matrices(T1, T2, Tc, A, B)
    return A.reshape(N, N), B.reshape(N, 1)


def two_mass_design(
    T1: float, T2: float, Tc: float, resonant_frequency: float, damping: float
) -> PolePlacement:
    """The design (5)–(8) as a record: the loop of (−k_I, k_1, k_3, k_2) on (∫e, ω_1, ω_2, m_s)."""
    k = np.empty(4)
    two_mass_gains(np.array([T1, Tc, resonant_frequency, damping]), np.array([T2]), k)
    A, B = drive_model(T1, T2, Tc)
    extended, b = with_integral(A[:3, :3], B[:3, 0], np.array([0.0, 1.0, 0.0]))
    pair = np.roots([1.0, 2.0 * damping * resonant_frequency, resonant_frequency**2])
    return design_of(extended, b, np.array([-k[0], k[1], k[3], k[2]]), [*pair, *pair])
