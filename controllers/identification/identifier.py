"""Takagi–Sugeno identification of a running system, after Barragán et al., as a block.

The block watches any signals in the loop, predicts the outputs one sample ahead with the NARX
model of `narx`, and adapts the model by the extended Kalman filter of
`adaptation`. It says what the model is worth (one-step prediction, free run,
innovation) and what it knows that a controller needs: ∂y/∂u over one sample.

**Wire the inputs with a delay of one sample**: at instant k the block wants u_{k−1}, which was
held while y went to y_k. That is also what lets a controller read the block's sensitivity at the
same instant without an algebraic loop.

At the start the model is persistence, y_k = y_{k−1} (plus `start_sensitivity`·u_{k−1}).

The step function is in `identifier_step`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_choice, require_not_negative, require_positive
from controllers.fuzzy.inference import Membership
from controllers.fuzzy.membership import KINDS
from controllers.fuzzy.takagi_sugeno import TakagiSugeno, grid, partition
from controllers.fuzzy.takagi_sugeno_kernels import model_work
from controllers.identification.adaptation import Adaptation
from controllers.identification.identifier_step import HEAD, STATE, TABLES, identifier_step
from controllers.identification.narx import Lags, Scale
from controllers.identification.offline import Uncertainty

Sets = int | Sequence[tuple[str, Sequence[float]]]
Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Identifier(Uncertainty):
    """Identifies a Takagi–Sugeno model of measured outputs online.

    Fields beside those of `Uncertainty`, which count in scaled units:

    measured, exogenous names of the measured outputs and of the inputs that drive them
    measured_ranges, exogenous_ranges  (low, high) of each [its unit]: scaled to [−1, 1]
    measured_units, exogenous_units    their units; left out, all "1"
    measured_lags, exogenous_lags      how many past values of each the model sees
    memberships         of regressors by name (`force_1` is the force one sample back): how many
                        functions of `kind` part its range, or a list of (kind, parameters) in
                        scaled units; those not named do not matter to the rules
    kind                kind of the functions that are only counted
    filter, p           "ekf", or "robust_ekf" with the mass p of the p-point score
    noise_std           √R_e of each output [its unit]; left out, 1 % of half its range
    start_sensitivity   of each output, of each input: ∂y/∂u at the start [units]; left out, 0
    sensitivity_bounds  (low, high) of the coefficient of every newest input in every local model,
                        for one output and one input [unit]: known sign and size of ∂y/∂u
    learn_from, learn_until      when it adapts [s since its first sample]
    free_run_from       from when the free run is on its own [s]
    model               a model in scaled units in place of the grid of `memberships`
    """

    measured: tuple[str, ...] = ("y",)
    exogenous: tuple[str, ...] = ("u",)
    measured_ranges: tuple[Range, ...] = ((-1.0, 1.0),)
    exogenous_ranges: tuple[Range, ...] = ((-1.0, 1.0),)
    measured_units: tuple[str, ...] = ()
    exogenous_units: tuple[str, ...] = ()
    measured_lags: int = 2
    exogenous_lags: int = 2
    memberships: Mapping[str, Sets] = field(default_factory=dict)
    kind: str = "gaussian"
    filter: str = "ekf"
    p: float = 0.05
    noise_std: tuple[float, ...] = ()
    start_sensitivity: tuple[tuple[float, ...], ...] = ()
    sensitivity_bounds: Range | None = None
    learn_from: float = 0.0
    learn_until: float = math.inf
    free_run_from: float = math.inf
    model: TakagiSugeno | None = None

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        super().__post_init__()
        m, q = len(self.measured), len(self.exogenous)
        names = (*self.measured, *self.exogenous)
        different = len(set(names)) == m + q
        require(different, "Identifier.measured, exogenous", "names that differ", names)
        for name, count in (("measured_ranges", m), ("exogenous_ranges", q)):
            _require_count(name, getattr(self, name), count)
        for name, count in (("measured_units", m), ("exogenous_units", q), ("noise_std", m),
                            ("start_sensitivity", m)):  # fmt: skip
            if getattr(self, name):
                _require_count(name, getattr(self, name), count)
        for row in self.start_sensitivity:
            require(len(row) == q, "Identifier.start_sensitivity", f"rows of {q} numbers", row)
        lagged = q == 0 or self.exogenous_lags > 0
        require(lagged, "Identifier.exogenous_lags", "at least 1", self.exogenous_lags)
        for name in ("learn_from", "learn_until", "free_run_from"):
            value = getattr(self, name)
            if value != math.inf:
                require_not_negative(f"Identifier.{name}", value)
        self._check_model()
        self.scales()
        self.adapted()

    def _check_model(self) -> None:
        """Raise `ControllerError` unless sets and model fit the regressor."""
        require_choice("Identifier.kind", self.kind, KINDS)
        legal = self.regressors
        for name in self.memberships:
            require_choice("Identifier.memberships", name, legal)
        if self.model is not None:
            received = (len(self.model.inputs), len(self.model.models))
            expected = (len(legal), len(self.measured))
            text = f"{expected[0]} inputs ({', '.join(legal)}) and {expected[1]} outputs"
            require(received == expected, "Identifier.model", text, received)
            none = len(self.memberships) == 0
            require(none, "Identifier.memberships", "none beside a model", self.memberships)
        if self.sensitivity_bounds is not None:
            low, high = self.sensitivity_bounds
            fits = len(self.measured) == len(self.exogenous) == 1 and low <= high
            text = "a pair (low, high), with one output and one input"
            require(fits, "Identifier.sensitivity_bounds", text, (low, high))

    @property
    def lags(self) -> Lags:
        """The form of the regressor."""
        counts = (len(self.measured), len(self.exogenous))
        return Lags(*counts, self.measured_lags, self.exogenous_lags)

    @property
    def regressors(self) -> tuple[str, ...]:
        """Names of the model's inputs."""
        return self.lags.names(self.measured, self.exogenous)

    def scales(self) -> tuple[Scale, ...]:
        """Scales of the outputs, then of the inputs."""
        return tuple(Scale(*one) for one in (*self.measured_ranges, *self.exogenous_ranges))

    def start_model(self) -> TakagiSugeno:
        """The model at the start, in scaled units."""
        if self.model is not None:
            return self.model
        sets = [_sets(self.memberships.get(name, 1), self.kind) for name in self.regressors]
        local = np.zeros((len(self.measured), 1 + len(sets)))
        for o in range(len(self.measured)):
            local[o, 1 + self.measured_lags * o] = 1.0
            for i in range(len(self.exogenous)):
                start = self.start_sensitivity[o][i] if self.start_sensitivity else 0.0
                local[o, self._newest(i)] = start / self._unit_of(o, i)
                # persistence about the middle of the input's range is persistence for u = 0
                scale = self.scales()[len(self.measured) + i]
                local[o, 0] += local[o, self._newest(i)] * scale.centre / scale.half
        return grid(sets, local.tolist())

    def adapted(self) -> Adaptation:
        """How the parameters of the start model are adapted."""
        model = self.start_model()
        halves = [scale.half for scale in self.scales()]
        stds = self.noise_std or tuple(0.01 * half for half in halves[: len(self.measured)])
        for std in stds:
            require_positive("Identifier.noise_std", std)
        r = tuple((std / half) ** 2 for std, half in zip(stds, halves, strict=False))
        return self.adaptation(model, r, filter=self.filter, p=self.p)

    def bounds(self, model: TakagiSugeno) -> tuple[Array, Array]:
        """Those of `Uncertainty`, and `sensitivity_bounds`."""
        lower, upper = super().bounds(model)
        if self.sensitivity_bounds is not None:
            at = slice(model.n_antecedent + self._newest(0), None, 1 + len(self.regressors))
            low, high = (value / self._unit_of(0, 0) for value in self.sensitivity_bounds)
            lower[at], upper[at] = low, high
        return lower, upper

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("Identifier.block: sample_time", sample_time)
        sizes, model = self._sizes(), self.start_model()
        scales = [(scale.centre, scale.half) for scale in self.scales()]
        tables: dict[str, ArrayLike] = {
            "scales": scales,
            "s": model.structure(),
            "c": self.adapted().constants(),
        }
        state = {"theta": model.theta(), "P": self.adapted().covariance()}
        return Block(
            inputs=self._inputs(),
            outputs=self._outputs(),
            step=identifier_step,
            parameters=np.concatenate([self._head(sample_time), TABLES.fill(tables, **sizes)]),
            state=STATE.fill(state, **sizes),
        )

    def _head(self, sample_time: float) -> Array:
        """The head of p, laid out by `HEAD`."""
        lags = self.lags
        learn_from, learn_until, free_from = (
            round(t / sample_time) if t < math.inf else math.inf
            for t in (self.learn_from, self.learn_until, self.free_run_from)
        )
        values: dict[str, ArrayLike] = {
            "outputs": lags.outputs, "inputs": lags.inputs, "output_lags": lags.output_lags,
            "input_lags": lags.input_lags, "learn_from": learn_from, "learn_until": learn_until,
            "free_from": free_from, "first": lags.first,
            "in_parameters": TABLES.table(HEAD.length, **self._sizes()),
            "in_state": STATE.table(**self._sizes()),
        }  # fmt: skip
        return HEAD.fill(values)

    def _sizes(self) -> dict[str, int]:
        """The sizes that the layouts of the step name."""
        model, adaptation = self.start_model(), self.adapted()
        s = model.structure()
        return {
            "outputs": len(self.measured), "regressors": len(self.regressors),
            "signals": len(self.scales()), "theta": len(model.theta()),
            "covariance": len(adaptation.covariance()), "structure": len(s),
            "constants": len(adaptation.constants()),
            "work": max(model_work(s), adaptation.work()),
        }  # fmt: skip

    def _inputs(self) -> tuple[Signal, ...]:
        names = (*self.measured, *self.exogenous)
        texts = ["measured"] * len(self.measured)
        texts += ["held over the sample that ends: delay its wire by one"] * len(self.exogenous)
        triples = zip(names, self._units(), texts, strict=True)
        return tuple(Signal(*one) for one in triples)

    def _outputs(self) -> tuple[Signal, ...]:
        units, made = self._units(), []
        for name, unit in zip(self.measured, units, strict=False):
            made += [
                Signal(f"{name}_predicted", unit, "one-step prediction, before it is learnt"),
                Signal(f"{name}_simulated", unit, "free run; measured until it is let go"),
                Signal(f"{name}_innovation", unit, "measured − predicted"),
                Signal(f"{name}_gamma", "1", "normalised innovation"),
            ]
        m = len(self.measured)
        for o, name in enumerate(self.measured):
            for i, known in enumerate(self.exogenous):
                unit = f"{units[o]}/{units[m + i]}".removesuffix("/1")
                text = f"∂{name}/∂{known} over the sample that begins"
                made.append(Signal(f"sensitivity_{name}_{known}", unit, text))
        made += [
            Signal("nis", "1", "normalised innovation squared"),
            Signal("p_trace", "1", "trace of P"),
            Signal("silent", "1", "outputs for which no rule fires"),
        ]
        model = self.start_model()
        starts = zip(model.parameter_names(), model.theta().tolist(), strict=True)
        return (*made, *(Signal(name, "1", "component of θ", start) for name, start in starts))

    def _units(self) -> tuple[str, ...]:
        outputs = self.measured_units or ("1",) * len(self.measured)
        return (*outputs, *(self.exogenous_units or ("1",) * len(self.exogenous)))

    def _newest(self, i: int) -> int:
        """Place of the newest value of input i in a local model (a_0, …, a_n)."""
        return 1 + self.measured_lags * len(self.measured) + self.exogenous_lags * i

    def _unit_of(self, o: int, i: int) -> float:
        """What 1 in scaled units is as ∂(output o)/∂(input i)."""
        scales = self.scales()
        return scales[o].half / scales[len(self.measured) + i].half


def _sets(given: Sets, kind: str) -> tuple[Membership, ...]:
    if isinstance(given, int):
        return partition(kind, given)
    return tuple(Membership(name, tuple(parameters)) for name, parameters in given)


def _require_count(name: str, given: Sequence[object], count: int) -> None:
    expected = f"{count} entries, one for each"
    require(len(given) == count, f"Identifier.{name}", expected, given)
