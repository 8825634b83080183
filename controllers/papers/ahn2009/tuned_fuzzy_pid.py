"""Fuzzy PID tuned online by an EKF or a robust EKF, section 2.4 of Ahn & Truong 2009.

At sample instant k the block computes the control with θ_k exactly as `FuzzyPID` does, and the
filters of the three axes turn θ_k into θ_{k+1}. Two ways of putting the instants together:

    alignment "paper"   after u_k: H of instant k, sensitivity (y_k − y_{k−1})/(u_k − u_{k−1})
                        as (40) prints it, innovation e_k
    alignment "causal"  before u_k: H of instant k−1, (y_k − y_{k−1})/(u_{k−1} − u_{k−2}),
                        innovation e_k: what the control held over [t_{k−1}, t_k] did to y_k

With Q = 0 nothing moves (P_0 = 0) and the block is bit-equal to `FuzzyPID`.

A sensitivity that comes in as an input belongs to the instant at which it comes in: with
"causal" it is used one instant later, together with the H of its own instant.

What the method does, whatever the plant: the first-order change of U_p at the inputs of H is
h·P·hᵀ times the innovation, where h has the sign of ∂y/∂u·e. With ∂y/∂u > 0 and "paper" that is
the sign of e_k·e_k ≥ 0: K_p can only be raised there, by measurement noise as well as by error.
With "causal" it is the sign of e_{k−1}·e_k, in which white measurement noise itself cancels in
the mean, though not the slower motion that it excites in the loop. In the same way K_d goes with
e·de/dt and K_i with e·∫e dt.

The step function, and how its arrays are laid out, is in `tuned_step`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import (
    require,
    require_choice,
    require_finite,
    require_not_negative,
    require_positive,
)
from controllers.core.limit import limit
from controllers.kalman.p_point import PPoint, gaussian_score
from controllers.papers.ahn2009.fuzzy_pid import AXES, LABELS, FuzzyPIDLaw
from controllers.papers.ahn2009.membership_view import Curves, axis_curves
from controllers.papers.ahn2009.tuned_step import TUNED, TUNER, tuned_fuzzy_pid_step
from controllers.papers.ahn2009.tuner import tune_work

Noise = float | tuple[float, float, float]
FILTERS = ("ekf", "robust_ekf")


@dataclass(frozen=True, kw_only=True)
class TunedFuzzyPID(FuzzyPIDLaw):
    """Fuzzy PID whose membership functions and weights a (robust) EKF tunes online.

    Fields beside those of `FuzzyPIDLaw` and `PIDLaw`:

    filter              "ekf", or "robust_ekf" (p-point score)
    p                   mass p of (18) of the robust filter
    r                   R, variance of the measured output about its target [measured_unit²];
                        left out, (error_range/50)²
    q_centre, q_half_width, q_weight
                        Q per sample of centres, half-widths, weights [1]; one number, or one
                        each for P, I and D; 0 keeps those components as they are
    vector              "reduced" (at most 12 components at a time, (49)) or "full" (34)
    sensitivity         "quotient" (40), or "input": ∂y/∂u comes in as a third input
    sensitivity_bounds  (low, high) between which it is kept, signs included; at the start it is
                        the one nearer 0 [measured_unit/output_unit]
    smallest_du         |Δu| below which the quotient keeps its value [output_unit]
    alignment           "paper" or "causal", see the module
    tune_when_saturated whether to tune while u is at its limit and y does not answer to it
    half_width_floor    least half-width, and least overlap of neighbours [1]
    centre_gap          least distance between the centres of neighbours [1]
    """

    sensitivity_bounds: tuple[float, float]
    r: float | None = None
    filter: str = "robust_ekf"
    p: float = 0.05
    q_centre: Noise = 1e-5
    q_half_width: Noise = 1e-5
    q_weight: Noise = 1e-4
    vector: str = "reduced"
    sensitivity: str = "quotient"
    smallest_du: float = 1e-3
    alignment: str = "causal"
    tune_when_saturated: bool = False
    half_width_floor: float = 0.02
    centre_gap: float = 0.02

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        super().__post_init__()
        require_choice("TunedFuzzyPID.filter", self.filter, FILTERS)
        require_choice("TunedFuzzyPID.vector", self.vector, ("reduced", "full"))
        require_choice("TunedFuzzyPID.sensitivity", self.sensitivity, ("quotient", "input"))
        require_choice("TunedFuzzyPID.alignment", self.alignment, ("paper", "causal"))
        require_positive("TunedFuzzyPID.r", self.R)
        require_not_negative("TunedFuzzyPID.smallest_du", self.smallest_du)
        require_positive("TunedFuzzyPID.half_width_floor", self.half_width_floor)
        require_positive("TunedFuzzyPID.centre_gap", self.centre_gap)
        crowded = self.centre_gap * (max(self.classes) - 1)
        require(crowded <= 1.0, "TunedFuzzyPID.centre_gap", "room for all centres", crowded)
        PPoint(self.p)
        bounds = tuple(self.sensitivity_bounds)
        object.__setattr__(self, "sensitivity_bounds", bounds)
        require(
            len(bounds) == 2 and bounds[0] <= bounds[1],
            "TunedFuzzyPID.sensitivity_bounds",
            "a pair (low, high)",
            bounds,
        )
        for value in bounds:
            require_finite("TunedFuzzyPID.sensitivity_bounds", value)
        for name in ("q_centre", "q_half_width", "q_weight"):
            for value in _three(name, getattr(self, name)):
                require_not_negative(f"TunedFuzzyPID.{name}", value)

    @property
    def R(self) -> float:
        """Measurement noise variance in force [measured_unit²]."""
        return (self.error_range / 50.0) ** 2 if self.r is None else self.r

    def process_noise(self) -> Array:
        """Diagonals of Q (37), (38) of p, i, d as rows."""
        triangles, weights = sum(self.classes), self.system("p").n_weights
        centre, width, weight = (
            _three(name, getattr(self, name)) for name in ("q_centre", "q_half_width", "q_weight")
        )
        rows = [
            [centre[a], width[a], width[a]] * triangles + [weight[a]] * weights for a in range(3)
        ]
        return np.array(rows, dtype=np.float64)

    def sizes(self) -> dict[str, int]:
        """The sizes that `TUNED` and `TUNER` name."""
        n = self.thetas().shape[1]
        return {"n": n, "work": tune_work(n)}

    def tuner_parameters(self) -> Array:
        """Parameters of the tuner, laid out by `TUNER`."""
        low, high = self.sensitivity_bounds
        robust = self.filter == "robust_ekf"
        values: dict[str, ArrayLike] = {
            "r": self.R,
            "reduced": self.vector == "reduced",
            "causal": self.alignment == "causal",
            "from_input": self.sensitivity == "input",
            "smallest_du": self.smallest_du,
            "low": low,
            "high": high,
            "floor": self.half_width_floor,
            "gap": self.centre_gap,
            "when_saturated": self.tune_when_saturated,
            "classes": self.classes,
            "score": PPoint(self.p).score() if robust else gaussian_score(),
            "in_state": TUNED.table(len(self.fuzzy_state()), **self.sizes()),
            "noise": self.process_noise(),
        }
        return TUNER.fill(values, **self.sizes())

    def tuner_state(self) -> Array:
        """State of the tuner at the start, laid out by `TUNED`."""
        start = limit(0.0, *self.sensitivity_bounds)
        return TUNED.fill({"sensitivity": start, "theta": self.thetas()}, **self.sizes())

    def tuner_outputs(self) -> tuple[Signal, ...]:
        """Outputs of the tuner in the order of the Y_ constants, then θ."""
        stated = self.measured_unit and self.output_unit
        unit = f"{self.measured_unit}/{self.output_unit}".removesuffix("/1") if stated else ""
        kinds = (
            ("gamma", "normalised innovation of the filter of axis"),
            ("nis", "normalised innovation squared of axis"),
            ("p_trace", "trace of P of axis"),
            ("p_least", "least variance in P of axis"),
        )
        n, m = self.classes
        pairs = [(j, 1) for j in range(1, n + 1)] + [(j, 2) for j in range(1, m + 1)]
        parts = ("a", "b_minus", "b_plus")
        labels = [f"{part}_{j}_{i}" for j, i in pairs for part in parts]
        labels += [f"w_{k + 1}" for k in range(self.system("p").n_weights)]
        starts = iter(self.thetas().ravel())
        return (
            Signal("sensitivity_used", unit, "∂y/∂u in force"),
            *(Signal(f"{k}_{a}", "1", f"{text} {a}") for k, text in kinds for a in AXES),
            *(
                Signal(f"mf_{a}_{label}", "1", "component of (34), tuned", float(next(starts)))
                for a in AXES
                for label in labels
            ),
        )

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        unit = self.tuner_outputs()[0].unit
        extra = (Signal("sensitivity", unit, "∂y/∂u over one sample"),)
        return Block(
            inputs=self.law_inputs() + (extra if self.sensitivity == "input" else ()),
            outputs=(*self.fuzzy_outputs(), *self.tuner_outputs(), *self.firing_outputs()),
            step=tuned_fuzzy_pid_step,
            parameters=np.concatenate(
                [self.fuzzy_parameters(sample_time, np.zeros((3, 0))), self.tuner_parameters()]
            ),
            state=np.concatenate([self.fuzzy_state(), self.tuner_state()]),
        )

    def membership_curves(self, values: Mapping[str, float]) -> dict[str, tuple[Curves, ...]]:
        """Curves of the axes P, I and D, from the values of the `mf_` outputs at one instant."""
        found = {}
        for axis in AXES:
            names = [s.name for s in self.tuner_outputs() if s.name.startswith(f"mf_{axis}_")]
            theta = np.array([values[name] for name in names])
            found[axis.upper()] = axis_curves(theta, self.classes, LABELS, f"weights of U_{axis}")
        return found


def _three(name: str, value: float | Sequence[float]) -> tuple[float, float, float]:
    if isinstance(value, (int, float)):
        return (value, value, value)
    triple = tuple(value)
    require(len(triple) == 3, f"TunedFuzzyPID.{name}", "one number or three (P, I, D)", triple)
    return (triple[0], triple[1], triple[2])
