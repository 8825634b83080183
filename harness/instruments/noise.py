"""Random signals: white, band-limited, low-pass, heavy-tailed, uniform, binary.

Each sampler draws its values in the order of the instants, so that cutting the instants into
chunks changes nothing. Two parts of one signal never share a generator.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from numpy.random import Generator, SeedSequence
from numpy.typing import NDArray

from harness.clock import nearest_nanosecond, seconds_of
from harness.instruments.checks import (
    Duration,
    NotNegative,
    Number,
    Positive,
    Probability,
    Signal,
    check_order,
    check_whole,
)
from harness.instruments.source import (
    FunctionSampler,
    Sampler,
    Times,
    Values,
    child_seed,
    generator,
)

# Exponents of a primitive polynomial over GF(2) of each order but the highest and 0: the register
# then runs through all 2^order − 1 states that are not zero.
TAPS: dict[int, list[int]] = {
    3: [1], 4: [1], 5: [2], 6: [1], 7: [1], 8: [2, 3, 4], 9: [4], 10: [3], 11: [2],
    12: [6, 8, 11], 13: [9, 10, 12], 14: [9, 11, 13], 15: [1], 16: [1, 3, 12],
}  # fmt: skip
RegisterOrder = Annotated[int, partial(check_whole, low=min(TAPS), high=max(TAPS))]


@dataclass(frozen=True)
class WhiteNoise(Signal, kind="white_noise"):
    """One independent normal value a sample instant: `std` its standard deviation, `mean`.

    Its spectrum therefore reaches to half the rate of whoever reads it; for a density that does
    not depend on the reader take `band_limited_noise`.
    """

    std: NotNegative
    mean: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws mean + std·n, n standard normal."""
        normal = generator(seed).standard_normal
        return FunctionSampler(lambda times_ns: self.mean + self.std * normal(len(times_ns)))


@dataclass(frozen=True)
class UniformNoise(Signal, kind="uniform"):
    """One independent value a sample instant, uniform in [low, high)."""

    low: Number
    high: Number

    def _settle(self) -> None:
        check_order(self, "low", "high")

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws low + (high − low)·r, r uniform in [0, 1)."""
        width, uniform = self.high - self.low, generator(seed).random
        return FunctionSampler(lambda times_ns: self.low + width * uniform(len(times_ns)))


@dataclass(frozen=True)
class HeavyTailedNoise(Signal, kind="heavy_tailed_noise"):
    """One independent value a sample instant: mean + scale·τ, τ of Student's t with `dof` ν
    degrees of freedom (any ν > 0).

    Variance scale²·ν/(ν − 2) for ν > 2, else infinite; excess kurtosis 6/(ν − 4) for ν > 4,
    else infinite; ν = 1 is the Cauchy distribution.
    """

    scale: NotNegative
    dof: Positive = 3.0
    mean: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws mean + scale·τ."""
        mean, scale, student = self.mean, self.scale, generator(seed).standard_t
        return FunctionSampler(lambda times_ns: mean + scale * student(self.dof, len(times_ns)))


@dataclass(frozen=True)
class ContaminatedNoise(Signal, kind="contaminated_noise"):
    """Tukey's contaminated normal: normal with `std`, but with probability `epsilon` ε the
    standard deviation is `ratio` r times as large (an outlier).

    Variance std²·(1 − ε + ε r²); kurtosis 3·(1 − ε + ε r⁴)/(1 − ε + ε r²)².
    """

    std: NotNegative
    epsilon: Probability = 0.05
    ratio: NotNegative = 10.0
    mean: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws a normal value from one stream and whether it is an outlier from another."""
        normal = generator(child_seed(seed, 0)).standard_normal
        uniform = generator(child_seed(seed, 1)).random

        def draw(times_ns: Times) -> Values:
            n = len(times_ns)
            std = np.where(uniform(n) < self.epsilon, self.std * self.ratio, self.std)
            return self.mean + std * normal(n)

        return FunctionSampler(draw)


@dataclass
class HeldNoiseSampler:
    """Normal values on the grid of `noise`, which begins at the first instant, held between."""

    noise: BandLimitedNoise
    random: Generator
    first: int | None = None
    drawn: int = 0
    last: float = 0.0

    def sample(self, times_ns: Times) -> Values:
        """The value of the interval that each instant lies in."""
        if len(times_ns) == 0:
            return np.empty(0)
        if self.first is None:
            self.first = int(times_ns[0])
        index = (times_ns - self.first) // nearest_nanosecond(self.noise.sample_time)
        fresh = int(index[-1]) + 1 - self.drawn
        std = math.sqrt(self.noise.power / self.noise.sample_time)
        values = self.noise.mean + std * self.random.standard_normal(fresh)
        known = np.concatenate(([self.last], values))
        held = known[index - self.drawn + 1]
        self.drawn += fresh
        self.last = float(known[-1])
        return held


@dataclass(frozen=True)
class BandLimitedNoise(Signal, kind="band_limited_noise"):
    """White noise up to a bandwidth: a new normal value every `sample_time` T (s), held between.

    `power` P is the height of the two-sided power spectral density at low frequency, in unit²/Hz
    (what Simulink's block calls noise power): variance P/T, density P·(sin πfT / πfT)², flat
    within 5 % up to f = 1/(8T). The grid of T begins at the first instant that is sampled.
    """

    power: NotNegative
    sample_time: Duration
    mean: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler that remembers the value in force."""
        return HeldNoiseSampler(self, generator(seed))


@dataclass
class LowPassNoiseSampler:
    """The recursion of `LowPassNoise`, instant by instant."""

    noise: LowPassNoise
    random: Generator
    previous: int | None = None
    value: float = 0.0

    def sample(self, times_ns: Times) -> Values:
        """The process at each instant; the first value has the stationary distribution."""
        if len(times_ns) == 0:
            return np.empty(0)
        before = times_ns[0] if self.previous is None else self.previous
        gaps = seconds_of(np.diff(times_ns, prepend=before))
        omega = 2.0 * math.pi * self.noise.bandwidth
        decay = [math.exp(-omega * gap) for gap in gaps.tolist()]
        if self.previous is None:
            decay[0] = 0.0
        values = np.empty(len(times_ns))
        x = self.value
        normals = self.random.standard_normal(len(times_ns)).tolist()
        for index, (a, normal) in enumerate(zip(decay, normals, strict=True)):
            x = a * x + math.sqrt(1.0 - a * a) * normal
            values[index] = x
        self.value, self.previous = x, int(times_ns[-1])
        return self.noise.mean + self.noise.std * values


@dataclass(frozen=True)
class LowPassNoise(Signal, kind="low_pass_noise"):
    """Coloured noise of standard deviation `std` whose density is flat up to `bandwidth` f_b (Hz)
    and falls by 20 dB a decade beyond: the Ornstein–Uhlenbeck process, sampled exactly.

    x(t+h) = a·x(t) + √(1 − a²)·n with a = exp(−2π f_b h); autocorrelation std²·exp(−2π f_b |h|);
    two-sided density std²/(π f_b) / (1 + (f/f_b)²). It does not depend on the reader's rate.
    """

    std: NotNegative
    bandwidth: Positive
    mean: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler that remembers the last instant and value."""
        return LowPassNoiseSampler(self, generator(seed))


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
