"""Fuzzy PID, eqs (2)–(7) and Table 2 of Ahn & Truong 2009.

Three fuzzy systems, each with its own membership functions and weights, read |e| and |de/dt|,
multiplied by their scale factors and limited to 1, and give U_p, U_i, U_d in [0, 1]:

    K_a = K_a0 + U_a·(K_a1 − K_a0),  a = p, i, d                                        (2)

The gains enter the law of `controllers.pid.pid`. de/dt is the law's filtered derivative, so of the
error or of −measured as `derivative_on` says. Where no rule of a system fires, its U keeps its
value; at the start that is 1/2.

Block arrays: p is `HEAD`, then `SYSTEMS`; x is `STATE`. The online tuner keeps θ in x instead, and
otherwise calls the same functions: with nothing to tune it is bit-equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_finite, require_positive
from controllers.core.layout import Layout, part, row_of
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

# State: scaled |e| and |de/dt|; U_p, U_i, U_d; work space of the systems p, i, d.
STATE = Layout.of(
    law=N_LAW_STATE, inputs=2, U=3,
    mu=(3, "functions"), firing=(3, "rules"), strength=(3, "weights"),
)  # fmt: skip
X_INPUTS, X_U = STATE.place("inputs"), STATE.place("U")
MU, FIRING, STRENGTH = map(STATE.number, ("mu", "firing", "strength"))

# Parameters: (K_a0, K_a1 − K_a0) of p, i, d; scale factors; tables of places; s and θ of p, i, d.
SYSTEMS = Layout.of(structure=(3, "structure"), theta=(3, "theta"))
HEAD = Layout.of(
    law=N_LAW, gains=(3, 2), scales=2, in_parameters=SYSTEMS.entries, in_state=STATE.entries
)
STRUCTURE, THETA = map(SYSTEMS.number, SYSTEMS.names)
P_GAINS, P_SCALES = HEAD.place("gains"), HEAD.place("scales")
P_IN_PARAMETERS, P_IN_STATE = HEAD.place("in_parameters"), HEAD.place("in_state")

# Outputs: U_p, U_i, U_d; scaled |e|, |de/dt|; systems without a firing rule.
OUTPUTS = Layout.of(law=N_LAW_OUTPUT, U=3, inputs=2, silent=(), end=())
Y_U_INFERRED, Y_INPUTS, Y_SILENT, N_FUZZY_OUTPUT = OUTPUTS.places()[1:]

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
    x[X_INPUTS] = scaled(x[ERROR], p[P_SCALES])
    x[X_INPUTS + 1] = scaled(x[DERIVATIVE], p[P_SCALES + 1])


def system_parameters(p: Array, which: int, axis: int) -> Array:
    """Structure or θ of the system of an axis, a view into p."""
    return row_of(part(p[P_IN_PARAMETERS:], p, which), axis, 3)


def system_state(p: Array, x: Array, which: int, axis: int) -> Array:
    """Memberships, firings or strengths of the system of an axis, a view into x."""
    return row_of(part(p[P_IN_STATE:], x, which), axis, 3)


def fuzzy_gain(p: Array, x: Array, axis: int, theta: Array) -> int:
    """U of one axis (0, 1, 2 for p, i, d) into x; returns 1 where no rule fires."""
    return infer(
        system_parameters(p, STRUCTURE, axis),
        theta,
        x[X_INPUTS:X_U],
        system_state(p, x, MU, axis),
        system_state(p, x, FIRING, axis),
        system_state(p, x, STRENGTH, axis),
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
        y[Y_U_INFERRED + a] = x[X_U + a]
    y[Y_INPUTS] = x[X_INPUTS]
    y[Y_INPUTS + 1] = x[X_INPUTS + 1]
    y[Y_SILENT] = float(silent)


def show_firing(p: Array, x: Array, at: int, y: Array) -> None:
    """Rule firings of the three systems into y from `at` on, as far as y has room."""
    firing = part(p[P_IN_STATE:], x, FIRING)
    if y.shape[0] >= at + firing.shape[0]:
        for i in range(firing.shape[0]):
            y[at + i] = firing[i]


def fuzzy_pid_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `FuzzyPID`: inputs reference, measured."""
    pid_sense(p, x, u[0], u[1])
    fuzzy_inputs(p, x)
    silent = 0
    for a in range(3):
        silent = silent + fuzzy_gain(p, x, a, system_parameters(p, THETA, a))
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

    def fuzzy_parameters(self, sample_time: float, thetas: Array) -> Array:
        """p with the θ (3, n) that do not change; n is 0 where the tuner has them."""
        structures = np.array([self.system(a).structure() for a in AXES])
        sizes = {"structure": structures.shape[1], "theta": thetas.shape[1]}
        head: dict[str, ArrayLike] = {
            "law": self.law_parameters(sample_time, max(self.ki, key=abs)),
            "gains": [(low, high - low) for low, high in (self.kp, self.ki, self.kd)],
            "scales": (1.0 / self.error_range, 1.0 / self.error_rate_range),
            "in_parameters": SYSTEMS.table(HEAD.length, **sizes),
            "in_state": STATE.table(**self.state_sizes()),
        }
        systems = SYSTEMS.fill({"structure": structures, "theta": thetas}, **sizes)
        return np.concatenate([HEAD.fill(head), systems])

    def thetas(self) -> Array:
        """θ of p, i and d as rows."""
        return np.array([self.system(a).theta() for a in AXES])

    def state_sizes(self) -> dict[str, int]:
        """The sizes that `STATE` names."""
        s = self.system("p")
        return {"functions": s.n_functions, "rules": len(s.rules), "weights": s.n_weights}

    def fuzzy_state(self) -> Array:
        """x of the law and the fuzzy systems at the start."""
        return STATE.fill({"U": np.full(3, 0.5)}, **self.state_sizes())

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
        parameters = self.fuzzy_parameters(sample_time, self.thetas())
        state = self.fuzzy_state()
        names = [*LAW_PARAMETER_NAMES, "kp_0", "delta_kp", "ki_0", "delta_ki", "kd_0", "delta_kd"]
        names += [f"p_{i}" for i in range(len(names), len(parameters))]
        return Block(
            inputs=self.law_inputs(),
            outputs=(*self.fuzzy_outputs(), *self.firing_outputs()),
            step=fuzzy_pid_step,
            parameters=parameters,
            parameter_names=tuple(names),
            tunable=LAW_TUNABLE,
            state=state,
            state_names=(*LAW_STATE_NAMES, *(f"x_{i}" for i in range(N_LAW_STATE, len(state)))),
        )
