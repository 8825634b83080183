"""Signals that switch between two levels: pulse, square wave, pseudo-random binary sequence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from numpy.random import SeedSequence
from numpy.typing import NDArray

from harness.clock import nearest_nanosecond
from harness.instruments.checks import (
    Duration,
    Number,
    Signal,
    Time,
    Waveform,
    check_number,
    check_order,
    check_whole,
)
from harness.instruments.source import FunctionSampler, Sampler, Times, Values, generator

OpenShare = Annotated[float, partial(check_number, above=0.0, below=1.0)]

# Exponents of a primitive polynomial over GF(2) of each order but the highest and 0: the register
# then runs through all 2^order − 1 states that are not zero.
TAPS: dict[int, list[int]] = {
    3: [1], 4: [1], 5: [2], 6: [1], 7: [1], 8: [2, 3, 4], 9: [4], 10: [3], 11: [2], 12: [6, 8,
    11], 13: [9, 10, 12], 14: [9, 11, 13], 15: [1], 16: [1, 3, 12],
}  # fmt: skip
RegisterOrder = Annotated[int, partial(check_whole, low=min(TAPS), high=max(TAPS))]


@dataclass(frozen=True)
class Pulse(Waveform, kind="pulse"):
    """bias + amplitude for `width` seconds from `start_time` on, else bias; again every `period`
    seconds where one is given."""

    amplitude: Number
    width: Duration
    start_time: Time = 0.0
    period: Duration | None = None
    bias: Number = 0.0

    def _settle(self) -> None:
        check_order(self, "width", "period")

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
    from scipy.signal import max_len_seq

    bits: NDArray[np.int8] = max_len_seq(order, taps=TAPS[order])[0]
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
