"""Signals that switch between two levels: pulse, square wave, pseudo-random binary sequence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from numpy.random import SeedSequence
from numpy.typing import NDArray

from harness.clock import nearest_nanosecond
from harness.errors import ExperimentError
from harness.instruments.checks import (
    Duration,
    Number,
    Signal,
    Time,
    Waveform,
    check_number,
    check_whole,
    label,
)
from harness.instruments.source import FunctionSampler, Sampler, Times, Values, generator

OpenShare = Annotated[float, partial(check_number, above=0.0, below=1.0)]

# Exponents of a primitive polynomial over GF(2) of each order: the register then runs through
# all 2^order − 1 states that are not zero.
PRIMITIVE_TAPS: dict[int, tuple[int, ...]] = {
    3: (3, 2),
    4: (4, 3),
    5: (5, 3),
    6: (6, 5),
    7: (7, 6),
    8: (8, 6, 5, 4),
    9: (9, 5),
    10: (10, 7),
    11: (11, 9),
    12: (12, 6, 4, 1),
    13: (13, 4, 3, 1),
    14: (14, 5, 3, 1),
    15: (15, 14),
    16: (16, 15, 13, 4),
}
RegisterOrder = Annotated[
    int, partial(check_whole, low=min(PRIMITIVE_TAPS), high=max(PRIMITIVE_TAPS))
]


@dataclass(frozen=True)
class Pulse(Waveform, kind="pulse"):
    """bias + amplitude for `width` seconds from `start_time` on, else bias; again every `period`
    seconds where one is given."""

    amplitude: Number
    width: Duration
    start_time: Time = 0.0
    period: Duration | None = None
    bias: Number = 0.0

    def __post_init__(self) -> None:
        """Checks every field."""
        super().__post_init__()
        if self.period is not None and self.width > self.period:
            raise ExperimentError(
                f"{label(self)}: 'width' must be at most 'period' {self.period!r}, "
                f"got {self.width!r}"
            )

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        start, width = nearest_nanosecond(self.start_time), nearest_nanosecond(self.width)
        period = None if self.period is None else nearest_nanosecond(self.period)
        low, high = float(self.bias), float(self.bias + self.amplitude)
        elapsed = times_ns - start
        within = elapsed if period is None else elapsed % period
        return np.where((elapsed >= 0) & (within < width), high, low)


@dataclass(frozen=True)
class Square(Waveform, kind="square"):
    """bias + amplitude for the first `duty` share of every `period` (s), bias − amplitude for
    the rest; bias before `start_time`. Both edges are rounded to whole nanoseconds."""

    amplitude: Number
    period: Duration
    duty: OpenShare = 0.5
    start_time: Time = 0.0
    bias: Number = 0.0

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        start, period = nearest_nanosecond(self.start_time), nearest_nanosecond(self.period)
        width = nearest_nanosecond(self.duty * self.period)
        low, high = float(self.bias - self.amplitude), float(self.bias + self.amplitude)
        elapsed = times_ns - start
        waves = np.where(elapsed % period < width, high, low)
        return np.where(elapsed >= 0, waves, float(self.bias))


def maximal_length_bits(order: int) -> NDArray[np.int8]:
    """One period, 2^order − 1 bits, of the linear feedback shift register of this order."""
    taps = PRIMITIVE_TAPS[order]
    register = (1 << order) - 1
    bits = np.empty((1 << order) - 1, dtype=np.int8)
    for index in range(len(bits)):
        bits[index] = register & 1
        feedback = 0
        for tap in taps:
            feedback ^= register >> (order - tap)
        register = (register >> 1) | ((feedback & 1) << (order - 1))
    return bits


@dataclass(frozen=True)
class Prbs(Signal, kind="prbs"):
    """bias ± amplitude by a maximal-length pseudo-random binary sequence, held for `bit_time` (s)
    on a grid anchored at time 0.

    It repeats after (2^order − 1)·bit_time and has autocorrelation amplitude² at lag 0 and
    −amplitude²/(2^order − 1) at all others. The seed chooses where in the period it begins.
    """

    amplitude: Number
    bit_time: Duration
    order: RegisterOrder = 7
    bias: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory whose place in the period comes from `seed`."""
        high = maximal_length_bits(self.order) == 1
        levels = self.bias + np.where(high, float(self.amplitude), -float(self.amplitude))
        begin = int(generator(seed).integers(len(levels)))
        bit = nearest_nanosecond(self.bit_time)
        return FunctionSampler(lambda times_ns: levels[(times_ns // bit + begin) % len(levels)])
