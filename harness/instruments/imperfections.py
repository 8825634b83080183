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
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from harness.errors import ExperimentError
from harness.instruments import imperfection_steps as steps
from harness.instruments.checks import (
    build,
    check_choice,
    check_number,
    check_one_of,
    check_signal,
    check_time,
    check_whole,
    label,
)
from harness.instruments.noise import UniformNoise, WhiteNoise
from harness.instruments.signals import with_signals
from harness.instruments.source import SignalSource
from harness.instruments.value_map import ValueMap
from harness.system.block import KernelBlock, Port, StepFunction

LONGEST_DELAY = 1_000_000  # readings, 8 MB of state


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


def _block(
    step: StepFunction,
    unit: str,
    parameters: tuple[float, ...] = (),
    state: tuple[float, ...] = (),
    added: Port | None = None,
) -> KernelBlock:
    inputs = (Port("in", unit, "what the wire carries"), *((added,) if added else ()))
    return KernelBlock(
        inputs=inputs,
        outputs=(Port("out", unit, "what the reader gets"),),
        step=step,
        parameters=np.array(parameters, dtype=np.float64),
        state=np.array(state, dtype=np.float64),
    )


@dataclass(frozen=True)
class Noise:
    """Adds white noise of standard deviation `std` (unit of the wire), or any random `signal`."""

    kind: ClassVar[str] = "noise"
    std: float | None = None
    signal: SignalSource | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_one_of(self, "std", "signal")
        if self.std is not None:
            check_number(self, "std", at_least=0.0)
        else:
            check_signal(self, self.signal)

    @property
    def source(self) -> SignalSource | None:
        """The noise."""
        return self.signal if self.std is None else WhiteNoise(self.std)

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in + added."""
        return _block(steps.add_step, unit, added=Port("added", unit, "the noise"))


@dataclass(frozen=True)
class Disturbance:
    """Adds a `signal`."""

    kind: ClassVar[str] = "disturbance"
    signal: SignalSource

    def __post_init__(self) -> None:
        """Checks every field."""
        check_signal(self, self.signal)

    @property
    def source(self) -> SignalSource | None:
        """The disturbance."""
        return self.signal

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in + added."""
        return _block(steps.add_step, unit, added=Port("added", unit, "the disturbance"))


@dataclass(frozen=True)
class Bias:
    """Adds the constant `value` (unit of the wire)."""

    kind: ClassVar[str] = "bias"
    value: float
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "value")

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = in + value."""
        return _block(steps.affine_step, unit, (1.0, self.value))


@dataclass(frozen=True)
class Gain:
    """Multiplies by `factor`: a scale error; the unit stays."""

    kind: ClassVar[str] = "gain"
    factor: float
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "factor")

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = factor·in."""
        return _block(steps.affine_step, unit, (self.factor, 0.0))


@dataclass(frozen=True)
class Quantisation:
    """Rounds to the nearest multiple of `step` (unit of the wire): mid-tread, so that 0 stays 0,
    and halves go to the even multiple, so that no bias arises. Error at most step/2."""

    kind: ClassVar[str] = "quantisation"
    step: float
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "step", above=0.0)

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = step·round(in/step)."""
        return _block(steps.quantise_step, unit, (self.step,))


@dataclass(frozen=True)
class Saturation:
    """Limits to [`lower`, `upper`] (unit of the wire)."""

    kind: ClassVar[str] = "saturation"
    lower: float
    upper: float
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "lower")
        check_number(self, "upper")
        if self.lower > self.upper:
            raise ExperimentError(
                f"{label(self)}: 'upper' must not be below 'lower' {self.lower!r}, "
                f"got {self.upper!r}"
            )

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out = min(max(in, lower), upper)."""
        return _block(steps.saturate_step, unit, (self.lower, self.upper))


@dataclass(frozen=True)
class RateLimit:
    """Rises by at most `rate` and falls by at most `falling_rate` (unit of the wire per second;
    `rate` where None). The first reading passes as it is."""

    kind: ClassVar[str] = "rate_limit"
    rate: float
    falling_rate: float | None = None
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "rate", at_least=0.0)
        if self.falling_rate is not None:
            check_number(self, "falling_rate", at_least=0.0)

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """|out_k − out_{k−1}| ≤ rate·sample_time."""
        falling = self.rate if self.falling_rate is None else self.falling_rate
        limits = (self.rate * sample_time, falling * sample_time)
        return _block(steps.rate_limit_step, unit, limits, (0.0, 0.0))


@dataclass(frozen=True)
class DelaySamples:
    """Gives the value read `samples` readings ago, `initial` (unit of the wire) until then."""

    kind: ClassVar[str] = "delay_samples"
    samples: int
    initial: float = 0.0
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_whole(self, "samples", 0, LONGEST_DELAY)
        check_number(self, "initial")

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """out_k = in_{k−samples}."""
        if self.samples == 0:
            return _block(steps.pass_step, unit)
        return _block(steps.delay_step, unit, (), (0.0, *([self.initial] * self.samples)))


@dataclass(frozen=True)
class Dropout:
    """Loses each reading with `probability`, independently; the reader then sees the last one
    that arrived (`mode` "hold"; the very first reading always arrives) or 0 ("zero")."""

    kind: ClassVar[str] = "dropout"
    probability: float
    mode: str = "hold"

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "probability", at_least=0.0, at_most=1.0)
        check_choice(self, "mode", "hold", "zero")

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
class Lag:
    """A first-order sensor, T·dy/dt + y = u with `time_constant` T (s), settled on the first
    reading. Exact for a value that moves in straight lines between the readings:

    y_k = a·y_{k−1} + (1 − b)·u_k + (b − a)·u_{k−1},  a = exp(−h/T),  b = (1 − a)·T/h
    """

    kind: ClassVar[str] = "lag"
    time_constant: float
    source: ClassVar[SignalSource | None] = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_time(self, "time_constant", positive=True)

    def block(self, sample_time: float, unit: str = "1") -> KernelBlock:
        """The recursion with h = `sample_time`."""
        ratio = sample_time / self.time_constant
        a, b = math.exp(-ratio), -math.expm1(-ratio) / ratio
        return _block(steps.lag_step, unit, (a, 1.0 - b, b - a), (0.0, 0.0, 0.0))


_KINDS: tuple[type[Any], ...] = (
    Noise,
    Disturbance,
    Bias,
    Gain,
    Quantisation,
    Saturation,
    RateLimit,
    DelaySamples,
    Dropout,
    Lag,
    ValueMap,
)

IMPERFECTIONS: dict[str, type[Any]] = {one.kind: one for one in _KINDS}


def make_imperfection(kind: str, parameters: Mapping[str, Any]) -> Imperfection:
    """The imperfection of this kind, or of a class of your own, "package.module:Class"; `signal`
    may be a table with `kind` beside its own keys.

    Raises `ExperimentError` naming an unknown kind or key with the nearest legal ones, a missing
    key, or a value out of its bounds.
    """
    given = with_signals(kind, parameters)
    made: Imperfection = build("imperfection", Imperfection, IMPERFECTIONS, kind, given)
    return made
