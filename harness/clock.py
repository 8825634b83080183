"""Integer time: seconds become whole nanoseconds once, where they enter, and stay so.

The k-th instant of a rate is `phase + k * period`, never an accumulated float.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING

from harness.errors import TimingError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NANOSECONDS = 1_000_000_000
LONGEST = 9.2e9
"""Seconds beyond which int64 nanoseconds overflow (292 years)."""

_ROUNDING = 1e-12  # relative; 0.1 + 0.2 means 0.3, but 1/3 s is no whole number of nanoseconds


def to_nanoseconds(seconds: float, what: str) -> int:
    """`seconds` as whole nanoseconds; raises `TimingError` naming `what` when it is none."""
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
        raise TimingError(f"{what} must be a number of seconds, not {seconds!r}")
    if not math.isfinite(seconds) or abs(seconds) > LONGEST:
        raise TimingError(f"{what} must be finite and below {LONGEST:g} s, not {seconds} s")
    whole = round(seconds * NANOSECONDS)
    if abs(seconds * NANOSECONDS - whole) > max(_ROUNDING * abs(whole), 1e-6):
        raise TimingError(f"{what} of {seconds!r} s is no whole number of nanoseconds")
    return whole


def nearest_nanosecond(seconds: float) -> int:
    """The whole nanosecond nearest to `seconds`, for edges of signals, which need no grid."""
    return round(Fraction(seconds) * NANOSECONDS)


def to_period(seconds: float, what: str) -> int:
    """A positive number of nanoseconds; raises `TimingError` otherwise."""
    period = to_nanoseconds(seconds, what)
    if period <= 0:
        raise TimingError(f"{what} must be positive, not {seconds!r} s")
    return period


def to_seconds(nanoseconds: int) -> float:
    """The double nearest to that many nanoseconds, in seconds."""
    return nanoseconds / NANOSECONDS


def seconds_of(times_ns: NDArray[np.int64]) -> NDArray[np.float64]:
    """The double nearest to each instant, in seconds (below 2^53 ns, which is 104 days)."""
    return times_ns / float(NANOSECONDS)


def show(nanoseconds: int) -> str:
    """Nanoseconds as people write them: "10 ms", "100 µs", "1.5 s"."""
    for unit, size in (("s", NANOSECONDS), ("ms", 1_000_000), ("µs", 1_000)):
        if nanoseconds % size == 0 or abs(nanoseconds) >= size:
            return f"{nanoseconds / size:.9g} {unit}"
    return f"{nanoseconds} ns"


def common_cycle(periods: Iterable[int]) -> int:
    """The least common multiple of all periods."""
    return math.lcm(*periods)
