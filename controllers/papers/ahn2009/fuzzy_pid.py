"""Fuzzy PID, eqs (2)–(7) and Table 2 of Ahn & Truong 2009.

Three fuzzy systems, each with its own membership functions and weights, read |e| and |de/dt|,
multiplied by their scale factors and limited to 1, and give U_p, U_i, U_d in [0, 1]:

    K_a = K_a0 + U_a·(K_a1 − K_a0),  a = p, i, d                                        (2)

The gains enter the law of `controllers.pid.pid`. de/dt is the law's filtered derivative, so of the
error or of −measured as `derivative_on` says. Where no rule of a system fires, its U keeps its
value; at the start that is 1/2.

The step function, and how its arrays are laid out, is in `fuzzy_pid_step`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_finite, require_positive
from controllers.fuzzy.inference import (
    FuzzySystem,
    Membership,
    grid_rules,
    triangular_partition,
)
from controllers.papers.ahn2009.fuzzy_pid_step import HEAD, STATE, SYSTEMS, fuzzy_pid_step
from controllers.pid.pid import (
    LAW_PARAMETER_NAMES,
    LAW_STATE_NAMES,
    LAW_TUNABLE,
    N_LAW_STATE,
    PIDLaw,
)

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
