"""Fuzzy estimator of the load's time constant, equations (11) and (12) of Serkies & Szabat 2013.

While the drive accelerates with a wrong T_2 in its estimator, the missing torque shows as an error
of the estimated load torque. At sample instant k, with dead zones D and the latched torque m̄_L:

    er_k = er_{k−1} + T·D(m̄_L − m_L)·D(ω_ref − ω_1)·k_T          (11), with the dt that it lacks
    T_2, k_T, q, r = fuzzy(er, ω_ref)                             (12)

The torque error is negative for a T_2 above the estimator's while accelerating, and so is the
product in both directions. As T_2 goes back to the estimator, er is the integrator of a loop: it
stops where the load torque no longer answers acceleration.

- The true load torque is not known. m̄_L is the estimate before the transient: it follows the
  estimate by a first-order lag while ω_ref − ω_1 is inside its dead zone, and is held outside.
- The dead zone of the speed error is max(floor, share·|ω_ref|), so that a load step passes.
- er and ω_ref are limited to the tops of their outer membership functions.

The 18 rules are two tables over 3 × 3 triangles: nine for (T_2, k_T), nine for (q, r). With the
product as AND the triangles interpolate the tables.

This module refuses to know the filter that gives m_L, and the control.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_finite, require_not_negative, require_positive
from controllers.core.layout import Layout, part
from controllers.core.limit import limit
from controllers.fuzzy.inference import FuzzySystem, Membership, Rule, infer
from controllers.fuzzy.map_block import STRUCTURE, SYSTEM, THETA

Table = tuple[tuple[float, ...], ...]

# State: the last four are those of the fuzzy system; `out` are T_2, k_T, q, r.
STATE = Layout.of(
    started=(), er=(), latched=(), out=4, inputs=2, mu="functions", firing="rules",
    strength="weights",
)  # fmt: skip
STARTED, ER, LATCHED, OUT, INPUTS, WORK = STATE.places()
MU, FIRING, STRENGTH = map(STATE.number, ("mu", "firing", "strength"))
T2, KT, Q, R = range(4)

# Parameters: `HEAD`, then the fuzzy system.
HEAD = Layout.of(
    ts=(), torque_zone=(), speed_floor=(), speed_share=(), latch=(), er_min=(), er_max=(),
    speed_min=(), speed_max=(), in_parameters=SYSTEM.entries, in_state=STATE.entries,
)  # fmt: skip
(TS, TORQUE_ZONE, SPEED_FLOOR, SPEED_SHARE, LATCH, ER_MIN, ER_MAX, SPEED_MIN, SPEED_MAX,
 IN_PARAMETERS, IN_STATE) = HEAD.places()  # fmt: skip

OUTPUT_NAMES = ("load_time_constant", "q_scale", "r_scale", "k_t", "er", "torque_error",
                "speed_error", "latched_load_torque", "active")  # fmt: skip


def dead_zone(value: float, width: float) -> float:
    """0 within ±width, value ∓ width outside."""
    if value > width:
        return value - width
    if value < -width:
        return value + width
    return 0.0


def infer_tables(p: Array, x: Array, er: float, speed: float) -> None:
    """T_2, k_T, q, r for er and ω_ref, into the state."""
    in_p = p[IN_PARAMETERS:]
    in_x = p[IN_STATE:]
    x[INPUTS] = limit(er, p[ER_MIN], p[ER_MAX])
    x[INPUTS + 1] = limit(speed, p[SPEED_MIN], p[SPEED_MAX])
    infer(
        part(in_p, p, STRUCTURE), part(in_p, p, THETA), x[INPUTS:WORK], part(in_x, x, MU),
        part(in_x, x, FIRING), part(in_x, x, STRENGTH), x[OUT:INPUTS],
    )  # fmt: skip


def inertia_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs: reference ω_ref, measured ω_1, estimated load torque m_L."""
    if x[STARTED] == 0.0:
        x[STARTED] = 1.0
        x[LATCHED] = u[2]
        infer_tables(p, x, x[ER], u[0])
    width = max(p[SPEED_FLOOR], p[SPEED_SHARE] * abs(u[0]))
    speed_error = dead_zone(u[0] - u[1], width)
    if speed_error == 0.0:
        x[LATCHED] = x[LATCHED] + p[LATCH] * (u[2] - x[LATCHED])
    torque_error = dead_zone(x[LATCHED] - u[2], p[TORQUE_ZONE])
    er = x[ER] + p[TS] * torque_error * speed_error * x[OUT + KT]
    x[ER] = limit(er, p[ER_MIN], p[ER_MAX])
    infer_tables(p, x, x[ER], u[0])
    y[0] = x[OUT + T2]
    y[1] = x[OUT + Q]
    y[2] = x[OUT + R]
    y[3] = x[OUT + KT]
    y[4] = x[ER]
    y[5] = torque_error
    y[6] = speed_error
    y[7] = x[LATCHED]
    y[8] = 1.0
    if speed_error == 0.0:
        y[8] = 0.0


def triangles(centres: tuple[float, ...]) -> tuple[Membership, ...]:
    """Triangles with these tops, each ending at its neighbours' tops; they sum to 1 between the
    first and the last."""
    steps = np.diff(centres)
    left = [steps[0], *steps]
    right = [*steps, steps[-1]]
    return tuple(
        Membership("triangular", (float(c), float(a), float(b)))
        for c, a, b in zip(centres, left, right, strict=True)
    )


@dataclass(frozen=True, kw_only=True)
class FuzzyInertiaEstimator:
    """Estimator of T_2 from the load torque that an observer sees.

    er_centres, speed_centres    ascending tops of the membership functions of er and ω_ref
    time_constants               T_2 [s], a row for each top of er and a column for each of ω_ref
    k_t, q_scale, r_scale        as many values of k_T [1/s], and of the factors of Q and R
    initial_er                   where er starts: T_2 is then that of the table there
    torque_dead_zone             of the error of the load torque
    speed_dead_zone              floor of the dead zone of the speed error
    speed_dead_zone_share        its share of |ω_ref|
    latch_time                   lag of the latched load torque [s]

    Outputs: load_time_constant, q_scale, r_scale, k_t, er, and what they are made of.
    """

    er_centres: tuple[float, ...]
    speed_centres: tuple[float, ...]
    time_constants: Table
    k_t: Table
    q_scale: Table
    r_scale: Table
    initial_er: float = 0.0
    torque_dead_zone: float = 0.05
    speed_dead_zone: float = 0.02
    speed_dead_zone_share: float = 0.1
    latch_time: float = 0.05

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        name = "FuzzyInertiaEstimator"
        for field in ("er_centres", "speed_centres"):
            centres = getattr(self, field)
            ascending = len(centres) >= 2 and all(np.diff(centres) > 0.0)
            require(bool(ascending), f"{name}.{field}", "at least two ascending tops", centres)
        shape = (len(self.er_centres), len(self.speed_centres))
        for field in ("time_constants", "k_t", "q_scale", "r_scale"):
            table = getattr(self, field)
            fits = len(table) == shape[0] and all(len(row) == shape[1] for row in table)
            positive = fits and all(value > 0.0 for row in table for value in row)
            require(positive, f"{name}.{field}", f"{shape[0]} rows of {shape[1]} above 0", table)
        for field in ("torque_dead_zone", "speed_dead_zone", "speed_dead_zone_share"):
            require_not_negative(f"{name}.{field}", getattr(self, field))
        require_positive(f"{name}.latch_time", self.latch_time)
        require_finite(f"{name}.initial_er", self.initial_er)

    def system(self) -> FuzzySystem:
        """The rules: a first half for (T_2, k_T), a second one for (q, r)."""
        tables = (self.time_constants, self.k_t, self.q_scale, self.r_scale)
        pairs = [
            (i, j) for i in range(len(self.er_centres)) for j in range(len(self.speed_centres))
        ]
        first = [Rule(pair, (k, k, -1, -1)) for k, pair in enumerate(pairs)]
        second = [Rule(pair, (-1, -1, k, k)) for k, pair in enumerate(pairs)]
        return FuzzySystem(
            inputs=(triangles(self.er_centres), triangles(self.speed_centres)),
            weights=tuple(tuple(float(v) for row in table for v in row) for table in tables),
            rules=(*first, *second),
            implication="product",
        )

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("FuzzyInertiaEstimator.block: sample_time", sample_time)
        system = self.system()
        tables = {"structure": system.structure(), "theta": system.theta()}
        sizes = {name: len(table) for name, table in tables.items()}
        sizes |= {"functions": system.n_functions, "rules": len(system.rules)}
        sizes["weights"] = system.n_weights
        head: dict[str, ArrayLike] = {
            "ts": sample_time, "torque_zone": self.torque_dead_zone,
            "speed_floor": self.speed_dead_zone, "speed_share": self.speed_dead_zone_share,
            "latch": 1.0 - math.exp(-sample_time / self.latch_time),
            "er_min": self.er_centres[0], "er_max": self.er_centres[-1],
            "speed_min": self.speed_centres[0], "speed_max": self.speed_centres[-1],
            "in_parameters": SYSTEM.table(HEAD.length, **sizes), "in_state": STATE.table(**sizes),
        }  # fmt: skip
        er = min(max(self.initial_er, self.er_centres[0]), self.er_centres[-1])
        state = STATE.fill({"er": er}, **sizes)
        p = np.concatenate([HEAD.fill(head), SYSTEM.fill(tables, **sizes)])
        return Block(
            inputs=(
                Signal("reference", "1", "ω_ref"),
                Signal("measured", "1", "ω_1"),
                Signal("load_torque", "1", "estimated m_L"),
            ),
            outputs=self._outputs(),
            step=inertia_step,
            parameters=p,
            parameter_names=tuple(f"p_{i}" for i in range(len(p))),
            state=state,
            state_names=tuple(f"x_{i}" for i in range(len(state))),
        )

    def _outputs(self) -> tuple[Signal, ...]:
        """Signals with the values that they have at `initial_er` and ω_ref = 0."""
        er = min(max(self.initial_er, self.er_centres[0]), self.er_centres[-1])
        speed = min(max(0.0, self.speed_centres[0]), self.speed_centres[-1])
        T2, k_t, q, r = (float(value) for value in self.system().evaluate(er, speed))
        return (
            Signal("load_time_constant", "s", "T_2 estimated", T2),
            Signal("q_scale", "1", "factor of Q", q),
            Signal("r_scale", "1", "factor of R", r),
            Signal("k_t", "1/s", "k_T, gain of the integral", k_t),
            Signal("er", "1", "integral of (11)", er),
            Signal("torque_error", "1", "latched − estimated load torque, outside its dead zone"),
            Signal("speed_error", "1", "ω_ref − ω_1, outside its dead zone"),
            Signal("latched_load_torque", "1", "load torque before the transient"),
            Signal("active", "1", "1 while the speed error is outside its dead zone"),
        )
