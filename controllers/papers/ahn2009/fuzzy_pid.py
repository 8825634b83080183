"""Fuzzy PID, eqs (2)–(7) and Table 2 of Ahn & Truong 2009.

Three fuzzy systems, each with its own membership functions and weights, read |e| and |de/dt|,
multiplied by their scale factors and limited to 1, and give U_p, U_i, U_d in [0, 1]:

    K_a = K_a0 + U_a·(K_a1 − K_a0),  a = p, i, d                                        (2)

The gains enter the law of `controllers.pid.pid`. de/dt is the law's filtered derivative, so of the
error or of −measured as `derivative_on` says. Where no rule of a system fires, its U keeps its
value; at the start that is 1/2.

Block arrays: p = [law | gains | scales | sizes | s_p s_i s_d | θ_p θ_i θ_d],
x = [law | fuzzy inputs | U | (mu firing strength) of p, i, d]. The online tuner keeps θ in x
instead, and otherwise calls the same functions: with nothing to tune it is bit-equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_finite, require_positive
from controllers.fuzzy.inference import (
    FuzzySystem,
    Membership,
    grid_rules,
    infer,
    triangular_partition,
)
from controllers.pid.pid import (
    DERIVATIVE,
    ERROR,
    LAW_PARAMETER_NAMES,
    LAW_STATE_NAMES,
    LAW_TUNABLE,
    N_LAW,
    N_LAW_OUTPUT,
    N_LAW_STATE,
    PIDLaw,
    pid_act,
    pid_sense,
)

# Parameters after the law: (K_a0, K_a1 − K_a0) of p, i, d; scale factors; sizes of the systems.
P_GAINS = N_LAW
P_SCALE_E, P_SCALE_DE = N_LAW + 6, N_LAW + 7
P_N_S, P_N_THETA, P_N_MU, P_N_RULES, P_N_WEIGHTS = range(N_LAW + 8, N_LAW + 13)
P_SYSTEMS = N_LAW + 13

# State after the law: scaled |e| and |de/dt|; U_p, U_i, U_d; work space of the systems.
X_INPUTS = N_LAW_STATE
X_U = N_LAW_STATE + 2
X_WORK = N_LAW_STATE + 5

Y_INFERRED = N_LAW_OUTPUT  # U_p, U_i, U_d; scaled |e|, |de/dt|; systems without a firing rule
Y_SILENT = N_LAW_OUTPUT + 5
N_FUZZY_OUTPUT = N_LAW_OUTPUT + 6

AXES = ("p", "i", "d")
LABELS = ("Z", "VS", "S", "M", "B")

# Table 2, rows |e| and columns |de| from Z to B, entries (U_p, U_i, U_d).
TABLE_2 = (
    (("VS", "B", "M"), ("VS", "B", "M"), ("Z", "B", "M"), ("Z", "B", "B"), ("Z", "B", "B")),
    (("VS", "B", "S"), ("VS", "B", "M"), ("VS", "B", "M"), ("Z", "M", "M"), ("Z", "M", "B")),
    (("S", "M", "VS"), ("S", "M", "VS"), ("S", "M", "VS"), ("VS", "S", "S"), ("VS", "S", "S")),
    (("M", "Z", "Z"), ("M", "Z", "Z"), ("M", "VS", "VS"), ("S", "VS", "VS"), ("S", "VS", "VS")),
    (("B", "Z", "Z"), ("B", "Z", "Z"), ("B", "Z", "Z"), ("B", "Z", "Z"), ("M", "Z", "Z")),
)


def scaled(value: float, scale: float) -> float:
    """|value|·scale limited to 1."""
    magnitude = abs(value) * scale
    if magnitude > 1.0:
        return 1.0
    return magnitude


def fuzzy_inputs(p: Array, x: Array) -> None:
    """The two inputs of the fuzzy systems, after `pid_sense`."""
    x[X_INPUTS] = scaled(x[ERROR], p[P_SCALE_E])
    x[X_INPUTS + 1] = scaled(x[DERIVATIVE], p[P_SCALE_DE])


def fuzzy_gain(p: Array, x: Array, axis: int, theta: Array) -> int:
    """U of one axis (0, 1, 2 for p, i, d) into x; returns 1 where no rule fires."""
    n_s = int(p[P_N_S])
    n_mu = int(p[P_N_MU])
    n_rules = int(p[P_N_RULES])
    n_weights = int(p[P_N_WEIGHTS])
    s_at = P_SYSTEMS + n_s * axis
    mu_at = X_WORK + (n_mu + n_rules + n_weights) * axis
    firing_at = mu_at + n_mu
    strength_at = firing_at + n_rules
    return infer(
        p[s_at : s_at + n_s],
        theta,
        x[X_INPUTS:X_U],
        x[mu_at:firing_at],
        x[firing_at:strength_at],
        x[strength_at : strength_at + n_weights],
        x[X_U + axis : X_U + axis + 1],
    )


def gain_in_force(p: Array, x: Array, axis: int) -> float:
    """K_a of (2)."""
    return float(p[P_GAINS + 2 * axis] + x[X_U + axis] * p[P_GAINS + 2 * axis + 1])


def fuzzy_act(p: Array, x: Array, silent: int, y: Array) -> None:
    """Control for the U in x, and the outputs of the law and of the fuzzy systems."""
    kp = gain_in_force(p, x, 0)
    ki = gain_in_force(p, x, 1)
    kd = gain_in_force(p, x, 2)
    pid_act(p, x, kp, ki, kd, y)
    for a in range(3):
        y[Y_INFERRED + a] = x[X_U + a]
    y[Y_INFERRED + 3] = x[X_INPUTS]
    y[Y_INFERRED + 4] = x[X_INPUTS + 1]
    y[Y_SILENT] = float(silent)


def show_firing(p: Array, x: Array, at: int, y: Array) -> None:
    """Rule firings of the three systems into y from `at` on, as far as y has room."""
    n_mu = int(p[P_N_MU])
    n_rules = int(p[P_N_RULES])
    width = n_mu + n_rules + int(p[P_N_WEIGHTS])
    if y.shape[0] >= at + 3 * n_rules:
        for a in range(3):
            for r in range(n_rules):
                y[at + n_rules * a + r] = x[X_WORK + width * a + n_mu + r]


def fuzzy_pid_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `FuzzyPID`: inputs reference, measured."""
    pid_sense(p, x, u[0], u[1])
    fuzzy_inputs(p, x)
    n_theta = int(p[P_N_THETA])
    silent = 0
    for a in range(3):
        at = P_SYSTEMS + 3 * int(p[P_N_S]) + n_theta * a
        silent = silent + fuzzy_gain(p, x, a, p[at : at + n_theta])
    fuzzy_act(p, x, silent, y)
    show_firing(p, x, N_FUZZY_OUTPUT, y)


Pair = tuple[float, float]
Table = tuple[tuple[tuple[str, ...], ...], ...]


@dataclass(frozen=True, kw_only=True)
class FuzzyPIDLaw(PIDLaw):
    """What fuzzy PID and tuned fuzzy PID have in common.

    kp, ki, kd        (K_a0, K_a1), the range of each gain [units as in `PID`]
    error_range       |e| that maps to 1; the scale factor is its reciprocal [measured_unit]
    error_rate_range  |de/dt| that maps to 1 [measured_unit/s]
    rules             entries (U_p, U_i, U_d) as labels Z VS S M B; rows |e|, columns |de|
    theta_p/i/d       vector (34) of each system: (a, b⁻, b⁺) of the functions of |e|, of |de|,
                      then the weights of Z … B; empty for equal triangles and equal intervals
    implication       "min" (7) or "product"
    aggregation       "sum" (5) or "max"
    rule_firing       offer the firing of every rule as an output
    """

    kp: Pair
    ki: Pair
    kd: Pair
    error_range: float
    error_rate_range: float
    rules: Table = TABLE_2
    theta_p: tuple[float, ...] = ()
    theta_i: tuple[float, ...] = ()
    theta_d: tuple[float, ...] = ()
    implication: str = "min"
    aggregation: str = "sum"
    rule_firing: bool = False

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        super().__post_init__()
        name = type(self).__name__
        for field in ("kp", "ki", "kd"):
            pair = tuple(getattr(self, field))
            object.__setattr__(self, field, pair)
            require(len(pair) == 2, f"{name}.{field}", "a pair (minimum, maximum)", pair)
            for value in pair:
                require_finite(f"{name}.{field}", value)
            require(pair[0] <= pair[1], f"{name}.{field}", "minimum not above maximum", pair)
        require_positive(f"{name}.error_range", self.error_range)
        require_positive(f"{name}.error_rate_range", self.error_rate_range)
        object.__setattr__(self, "rules", _freeze_table(f"{name}.rules", self.rules))
        for a in AXES:
            object.__setattr__(self, f"theta_{a}", tuple(getattr(self, f"theta_{a}")))
            self.system(a)

    @property
    def classes(self) -> tuple[int, int]:
        """Membership functions (n, m) of |e| and |de|."""
        return len(self.rules), len(self.rules[0])

    def system(self, axis: str) -> FuzzySystem:
        """The fuzzy system of axis "p", "i" or "d"."""
        n, m = self.classes
        theta = getattr(self, f"theta_{axis}")
        levels = len(LABELS)
        if theta:
            size = 3 * (n + m) + levels
            where = f"{type(self).__name__}.theta_{axis}"
            require(len(theta) == size, where, f"{size} numbers", len(theta))
            rows = [tuple(theta[3 * j : 3 * j + 3]) for j in range(n + m)]
            functions = tuple(Membership("triangular", row) for row in rows)
            inputs = (functions[:n], functions[n:])
            weights = theta[3 * (n + m) :]
        else:
            inputs = (triangular_partition(n), triangular_partition(m))
            weights = tuple(k / (levels - 1) for k in range(levels))
        place = AXES.index(axis)
        table = tuple(tuple(LABELS.index(c[place]) for c in row) for row in self.rules)
        return FuzzySystem(
            inputs, (weights,), grid_rules(table), self.implication, self.aggregation
        )

    def fuzzy_parameters(self, sample_time: float) -> Array:
        """p up to and with the structures s_p, s_i, s_d."""
        system = self.system("p")
        gains = [v for low, high in (self.kp, self.ki, self.kd) for v in (low, high - low)]
        structures = [self.system(a).structure() for a in AXES]
        sizes = [
            len(structures[0]),
            len(system.theta()),
            system.n_functions,
            len(system.rules),
            system.n_weights,
        ]
        scales = [1.0 / self.error_range, 1.0 / self.error_rate_range]
        law = self.law_parameters(sample_time, max(self.ki, key=abs))
        return np.concatenate([law, gains, scales, sizes, *structures])

    def thetas(self) -> Array:
        """θ_p, θ_i, θ_d one after the other."""
        return np.concatenate([self.system(a).theta() for a in AXES])

    def fuzzy_state(self) -> Array:
        """x of the law and the fuzzy systems at the start."""
        system = self.system("p")
        work = 3 * (system.n_functions + len(system.rules) + system.n_weights)
        return np.concatenate([np.zeros(X_U), np.full(3, 0.5), np.zeros(work)])

    def fuzzy_outputs(self) -> tuple[Signal, ...]:
        """Outputs of the law and the fuzzy systems in the order of the Y_ constants."""
        return (
            *self.law_outputs(),
            *(Signal(f"u_{a}", "1", f"U_{a} of eq. (4)") for a in AXES),
            Signal("error_scaled", "1", "input |e| of the fuzzy systems"),
            Signal("error_rate_scaled", "1", "input |de/dt| of the fuzzy systems"),
            Signal("silent", "1", "fuzzy systems in which no rule fires"),
        )

    def firing_outputs(self) -> tuple[Signal, ...]:
        """Firing of every rule, named by the classes of |e| and |de|, where asked for."""
        n, m = self.classes
        cells = [(a, i, j) for a in AXES for i in range(1, n + 1) for j in range(1, m + 1)]
        if not self.rule_firing:
            return ()
        return tuple(Signal(f"firing_{a}_{i}_{j}", "1", "height of eq. (7)") for a, i, j in cells)


def _freeze_table(where: str, rules: Sequence[Sequence[Sequence[str]]]) -> Table:
    table = tuple(tuple(tuple(cell) for cell in row) for row in rules)
    require(len(table) >= 2 and len(table[0]) >= 2, where, "at least 2 × 2 entries", table)
    for row in table:
        require(len(row) == len(table[0]), where, f"rows of {len(table[0])} entries", row)
        for cell in row:
            legal = len(cell) == 3 and all(label in LABELS for label in cell)
            require(legal, where, "entries (U_p, U_i, U_d) of labels " + " ".join(LABELS), cell)
    return table


@dataclass(frozen=True, kw_only=True)
class FuzzyPID(FuzzyPIDLaw):
    """Fuzzy PID with fixed membership functions; fields as in `FuzzyPIDLaw` and `PIDLaw`."""

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        fixed = self.fuzzy_parameters(sample_time)
        thetas = self.thetas()
        state = self.fuzzy_state()
        names = [*LAW_PARAMETER_NAMES, "kp_0", "delta_kp", "ki_0", "delta_ki", "kd_0", "delta_kd"]
        names += [f"p_{i}" for i in range(len(names), len(fixed) + len(thetas))]
        return Block(
            inputs=self.law_inputs(),
            outputs=(*self.fuzzy_outputs(), *self.firing_outputs()),
            step=fuzzy_pid_step,
            parameters=np.concatenate([fixed, thetas]),
            parameter_names=tuple(names),
            tunable=LAW_TUNABLE,
            state=state,
            state_names=(*LAW_STATE_NAMES, *(f"x_{i}" for i in range(N_LAW_STATE, len(state)))),
        )
