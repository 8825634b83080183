"""What is put on a wire between a value and its reader: noise, faults, sensor dynamics.

An imperfection is data. `block(sample_time, unit)` gives the block that the master runs at each
reading of the wire: input `in`, output `out`, both in the wire's unit, and where the imperfection
has a `source`, a second input `added` to which the planner wires that source. Imperfections on
one wire are applied in the order in which they are listed.

This module refuses to know rates and delays in time: the delay here counts readings.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import chain
from typing import Annotated, Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from harness.instruments import imperfection_steps as steps
from harness.instruments.checks import (
    Duration,
    Instrument,
    NotNegative,
    Number,
    OneSignal,
    Positive,
    Probability,
    build,
    check_choice,
    check_one_of,
    check_order,
    check_whole,
    is_number,
    require,
)
from harness.instruments.noise import UniformNoise, WhiteNoise
from harness.instruments.signals import with_signals
from harness.instruments.source import SignalSource
from harness.system.block import KernelBlock, Port, StepFunction

LONGEST_DELAY = 1_000_000  # readings, 8 MB of state
Readings = Annotated[int, partial(check_whole, low=0, high=LONGEST_DELAY)]
DropoutMode = Annotated[str, partial(check_choice, legal=("hold", "zero"))]


@runtime_checkable
class Imperfection(Protocol):
    """One thing on a wire, as data."""

    @property
    def source(self) -> SignalSource | None:
        """The signal for the second input, `added`; None where there is no such input."""
        ...

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """The block for readings every `sample_time` seconds of a wire in `unit`."""
        ...


class WireInstrument(Instrument):
    """An imperfection of this package; it meets `Imperfection`."""

    kinds: ClassVar[dict[str, type[Any]]] = {}

    @property
    def source(self) -> SignalSource | None:
        """None: there is no second input."""
        return None


def _block(
    step: StepFunction,
    unit: str,
    parameters: tuple[float, ...] = (),
    state: tuple[float, ...] = (),
    added: Port | None = None,
) -> KernelBlock:
    return KernelBlock(
        inputs=(Port("in", unit, "what the wire carries"), *((added,) if added else ())),
        outputs=(Port("out", unit, "what the reader gets"),),
        step=step,
        parameters=np.array(parameters, dtype=np.float64),
        state=np.array(state, dtype=np.float64),
    )


@dataclass(frozen=True)
class Noise(WireInstrument, kind="noise"):
    """Adds white noise of standard deviation `std` (unit of the wire), or any random `signal`."""

    std: NotNegative | None = None
    signal: OneSignal | None = None

    def _settle(self) -> None:
        check_one_of(self, "std", "signal")

    @property
    def source(self) -> SignalSource | None:
        """The noise."""
        return self.signal if self.std is None else WhiteNoise(self.std)

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in + added."""
        return _block(steps.add_step, unit, added=Port("added", unit, "the noise"))


@dataclass(frozen=True)
class Disturbance(WireInstrument, kind="disturbance"):
    """Adds a `signal`."""

    signal: OneSignal

    @property
    def source(self) -> SignalSource | None:
        """The disturbance."""
        return self.signal

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in + added."""
        return _block(steps.add_step, unit, added=Port("added", unit, "the disturbance"))


@dataclass(frozen=True)
class Bias(WireInstrument, kind="bias"):
    """Adds the constant `value` (unit of the wire)."""

    value: Number

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in + value."""
        return _block(steps.affine_step, unit, (1.0, self.value))


@dataclass(frozen=True)
class Gain(WireInstrument, kind="gain"):
    """Multiplies by `factor`: a scale error; the unit stays."""

    factor: Number

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = factor·in."""
        return _block(steps.affine_step, unit, (self.factor, 0.0))


@dataclass(frozen=True)
class Quantisation(WireInstrument, kind="quantisation"):
    """Rounds to the nearest multiple of `step` (unit of the wire): mid-tread, so that 0 stays 0,
    and halves go to the even multiple, so that no bias arises. Error at most step/2."""

    step: Positive

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = step·round(in/step)."""
        return _block(steps.quantise_step, unit, (self.step,))


@dataclass(frozen=True)
class Saturation(WireInstrument, kind="saturation"):
    """Limits to [`lower`, `upper`] (unit of the wire)."""

    lower: Number
    upper: Number

    def _settle(self) -> None:
        check_order(self, "lower", "upper")

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = min(max(in, lower), upper)."""
        return _block(steps.saturate_step, unit, (self.lower, self.upper))


@dataclass(frozen=True)
class RateLimit(WireInstrument, kind="rate_limit"):
    """Rises by at most `rate` and falls by at most `falling_rate` (unit of the wire per second;
    `rate` where None). The first reading passes as it is."""

    rate: NotNegative
    falling_rate: NotNegative | None = None

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """|out_k − out_{k−1}| ≤ rate·sample_time."""
        falling = self.rate if self.falling_rate is None else self.falling_rate
        limits = (self.rate * sample_time, falling * sample_time)
        return _block(steps.rate_limit_step, unit, limits, (0.0, 0.0))


@dataclass(frozen=True)
class DelaySamples(WireInstrument, kind="delay_samples"):
    """Gives the value read `samples` readings ago, `initial` (unit of the wire) until then."""

    samples: Readings
    initial: Number = 0.0

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out_k = in_{k−samples}."""
        if self.samples == 0:
            return _block(steps.pass_step, unit)
        return _block(steps.delay_step, unit, (), (0.0, *([self.initial] * self.samples)))


@dataclass(frozen=True)
class Dropout(WireInstrument, kind="dropout"):
    """Loses each reading with `probability`, independently; the reader then sees the last one
    that arrived (`mode` "hold"; the very first reading always arrives) or 0 ("zero")."""

    probability: Probability
    mode: DropoutMode = "hold"

    @property
    def source(self) -> SignalSource | None:
        """A number uniform in [0, 1) for each reading: lost where it is below `probability`."""
        return UniformNoise(0.0, 1.0, unit="1")

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in, or what the mode says where added < probability."""
        added = Port("added", "1", "uniform in [0, 1): below the probability the reading is lost")
        if self.mode == "zero":
            return _block(steps.dropout_zero_step, unit, (self.probability,), (), added)
        return _block(steps.dropout_hold_step, unit, (self.probability,), (0.0, 0.0), added)


@dataclass(frozen=True)
class Lag(WireInstrument, kind="lag"):
    """A first-order sensor, T·dy/dt + y = u with `time_constant` T (s), settled on the first
    reading. Exact for a value that moves in straight lines between the readings:

    y_k = a·y_{k−1} + (1 − b)·u_k + (b − a)·u_{k−1},  a = exp(−h/T),  b = (1 − a)·T/h
    """

    time_constant: Duration

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """The recursion with h = `sample_time`."""
        ratio = sample_time / self.time_constant
        a, b = math.exp(-ratio), -math.expm1(-ratio) / ratio
        return _block(steps.lag_step, unit, (a, 1.0 - b, b - a), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class ValueMap(WireInstrument, kind="value_map"):
    """Replaces values as the pairs (from, to) of `table` say, such as codes of a mode; what is not
    named stays."""

    table: tuple[tuple[float, float], ...]

    def _settle(self) -> None:
        pairs = self.table
        legal = isinstance(pairs, list | tuple) and all(
            isinstance(pair, list | tuple) and len(pair) == 2 and all(map(is_number, pair))
            for pair in pairs
        )
        require(self, "table", legal, "hold pairs of numbers")
        require(self, "table", len({a for a, _ in pairs}) == len(pairs), "map each value once")
        object.__setattr__(self, "table", tuple((float(a), float(b)) for a, b in pairs))

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = what the table says of in."""
        return _block(steps.value_map_step, unit, tuple(chain.from_iterable(self.table)))


IMPERFECTIONS = WireInstrument.kinds


def make_imperfection(kind: str, parameters: Mapping[str, Any]) -> Imperfection:
    """The imperfection of this kind, or of a class of your own, "package.module:Class"; `signal`
    may be a table with `kind` beside its own keys.

    Raises `ExperimentError` naming an unknown kind or key with the nearest legal ones, a missing
    key, or a value out of its bounds.
    """
    given = with_signals(kind, parameters)
    made: Imperfection = build("imperfection", Imperfection, IMPERFECTIONS, kind, given)
    return made
