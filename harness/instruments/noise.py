"""Random signals: white, band-limited, low-pass, heavy-tailed, uniform.

Each sampler draws its values in the order of the instants, so that cutting the instants into
chunks changes nothing. Two parts of one signal never share a generator.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.random import Generator, SeedSequence

from harness.clock import nearest_nanosecond, seconds_of
from harness.errors import ExperimentError
from harness.instruments.checks import check_number, check_time, check_unit, label
from harness.instruments.source import (
    Sampler,
    Times,
    Values,
    child_seed,
    generator,
)


@dataclass(frozen=True)
class IndependentSampler:
    """One independent draw a sample instant: `draw(n)` gives the next n values."""

    draw: Callable[[int], Values]

    def sample(self, times_ns: Times) -> Values:
        """The next `len(times_ns)` draws."""
        return self.draw(len(times_ns))


@dataclass(frozen=True)
class WhiteNoise:
    """One independent normal value a sample instant: `std` its standard deviation, `mean`.

    Its spectrum therefore reaches to half the rate of whoever reads it; for a density that does
    not depend on the reader take `band_limited_noise`.
    """

    kind: ClassVar[str] = "white_noise"
    std: float
    mean: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "std", at_least=0.0)
        check_number(self, "mean")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws mean + std·n, n standard normal."""
        normal = generator(seed).standard_normal
        return IndependentSampler(lambda n: self.mean + self.std * normal(n))


@dataclass(frozen=True)
class UniformNoise:
    """One independent value a sample instant, uniform in [low, high)."""

    kind: ClassVar[str] = "uniform"
    low: float
    high: float
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "low")
        check_number(self, "high")
        if self.low > self.high:
            raise ExperimentError(
                f"{label(self)}: 'high' must not be below 'low' {self.low!r}, got {self.high!r}"
            )
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws low + (high − low)·r, r uniform in [0, 1)."""
        uniform = generator(seed).random
        return IndependentSampler(lambda n: self.low + (self.high - self.low) * uniform(n))


@dataclass(frozen=True)
class HeavyTailedNoise:
    """One independent value a sample instant: mean + scale·τ, τ of Student's t with `dof` ν
    degrees of freedom (any ν > 0).

    Variance scale²·ν/(ν − 2) for ν > 2, else infinite; excess kurtosis 6/(ν − 4) for ν > 4,
    else infinite; ν = 1 is the Cauchy distribution.
    """

    kind: ClassVar[str] = "heavy_tailed_noise"
    scale: float
    dof: float = 3.0
    mean: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "scale", at_least=0.0)
        check_number(self, "dof", above=0.0)
        check_number(self, "mean")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws mean + scale·τ."""
        student = generator(seed).standard_t
        return IndependentSampler(lambda n: self.mean + self.scale * student(self.dof, n))


@dataclass(frozen=True)
class ContaminatedNoise:
    """Tukey's contaminated normal: normal with `std`, but with probability `epsilon` ε the
    standard deviation is `ratio` r times as large (an outlier).

    Variance std²·(1 − ε + ε r²); kurtosis 3·(1 − ε + ε r⁴)/(1 − ε + ε r²)².
    """

    kind: ClassVar[str] = "contaminated_noise"
    std: float
    epsilon: float = 0.05
    ratio: float = 10.0
    mean: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "std", at_least=0.0)
        check_number(self, "epsilon", at_least=0.0, at_most=1.0)
        check_number(self, "ratio", at_least=0.0)
        check_number(self, "mean")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Draws a normal value from one stream and whether it is an outlier from another."""
        normal = generator(child_seed(seed, 0)).standard_normal
        uniform = generator(child_seed(seed, 1)).random

        def draw(n: int) -> Values:
            std = np.where(uniform(n) < self.epsilon, self.std * self.ratio, self.std)
            return self.mean + std * normal(n)

        return IndependentSampler(draw)


@dataclass
class HeldNoiseSampler:
    """Normal values on a grid of `period` (ns) that begins at the first instant, held between."""

    std: float
    mean: float
    period: int
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
        index = (times_ns - self.first) // self.period
        fresh = int(index[-1]) + 1 - self.drawn
        values = self.mean + self.std * self.random.standard_normal(fresh)
        known = np.concatenate(([self.last], values))
        held = known[index - self.drawn + 1]
        self.drawn += fresh
        self.last = float(known[-1])
        return held


@dataclass(frozen=True)
class BandLimitedNoise:
    """White noise up to a bandwidth: a new normal value every `sample_time` T (s), held between.

    `power` P is the height of the two-sided power spectral density at low frequency, in unit²/Hz
    (what Simulink's block calls noise power): variance P/T, density P·(sin πfT / πfT)², flat
    within 5 % up to f = 1/(8T). The grid of T begins at the first instant that is sampled.
    """

    kind: ClassVar[str] = "band_limited_noise"
    power: float
    sample_time: float
    mean: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "power", at_least=0.0)
        check_time(self, "sample_time", positive=True)
        check_number(self, "mean")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler that remembers the value in force."""
        std = math.sqrt(self.power / self.sample_time)
        return HeldNoiseSampler(
            std, float(self.mean), nearest_nanosecond(self.sample_time), generator(seed)
        )


@dataclass
class LowPassNoiseSampler:
    """The recursion of `LowPassNoise`, instant by instant."""

    std: float
    mean: float
    omega: float
    random: Generator
    previous: int | None = None
    value: float = field(default=0.0)

    def sample(self, times_ns: Times) -> Values:
        """The process at each instant; the first value has the stationary distribution."""
        if len(times_ns) == 0:
            return np.empty(0)
        before = times_ns[0] if self.previous is None else self.previous
        gaps = seconds_of(np.diff(times_ns, prepend=before))
        decay = [math.exp(-self.omega * gap) for gap in gaps.tolist()]
        if self.previous is None:
            decay[0] = 0.0
        values = np.empty(len(times_ns))
        x = self.value
        for index, normal in enumerate(self.random.standard_normal(len(times_ns)).tolist()):
            a = decay[index]
            x = a * x + math.sqrt(1.0 - a * a) * normal
            values[index] = x
        self.value, self.previous = x, int(times_ns[-1])
        return self.mean + self.std * values


@dataclass(frozen=True)
class LowPassNoise:
    """Coloured noise of standard deviation `std` whose density is flat up to `bandwidth` f_b (Hz)
    and falls by 20 dB a decade beyond: the Ornstein–Uhlenbeck process, sampled exactly.

    x(t+h) = a·x(t) + √(1 − a²)·n with a = exp(−2π f_b h); autocorrelation std²·exp(−2π f_b |h|);
    two-sided density std²/(π f_b) / (1 + (f/f_b)²). It does not depend on the reader's rate.
    """

    kind: ClassVar[str] = "low_pass_noise"
    std: float
    bandwidth: float
    mean: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "std", at_least=0.0)
        check_number(self, "bandwidth", above=0.0)
        check_number(self, "mean")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler that remembers the last instant and value."""
        omega = 2.0 * math.pi * self.bandwidth
        return LowPassNoiseSampler(float(self.std), float(self.mean), omega, generator(seed))
