"""Integer time: seconds become whole nanoseconds once, where they enter, and stay so.

The k-th instant of a rate is `phase + k * period`, never an accumulated float.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from decimal import Decimal

from harness.errors import TimingError

NANOSECONDS = 1_000_000_000
_LIMIT = 2**62


def to_nanoseconds(seconds: float, what: str) -> int:
    """`seconds` as whole nanoseconds; raises `TimingError` when it is none, naming `what`.

    A float counts as the shortest decimal that stands for it, so 0.1 is exactly 100 000 000 ns.
    """
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
        raise TimingError(f"{what} must be a number of seconds, not {seconds!r}")
    if not math.isfinite(seconds):
        raise TimingError(f"{what} must be finite, not {seconds} s")
    exact = Decimal(repr(seconds)) * NANOSECONDS
    whole = int(exact.to_integral_value())
    if exact != whole:
        raise TimingError(f"{what} of {seconds!r} s is no whole number of nanoseconds")
    if abs(whole) > _LIMIT:
        raise TimingError(f"{what} of {seconds!r} s is beyond the range of integer nanoseconds")
    return whole


def to_period(seconds: float, what: str) -> int:
    """A positive number of nanoseconds; raises `TimingError` otherwise."""
    period = to_nanoseconds(seconds, what)
    if period <= 0:
        raise TimingError(f"{what} must be positive, not {seconds!r} s")
    return period


def to_seconds(nanoseconds: int) -> float:
    """The double nearest to that many nanoseconds, in seconds."""
    return nanoseconds / NANOSECONDS


def show(nanoseconds: int) -> str:
    """Nanoseconds as people write them: "10 ms", "100 µs", "1.5 s"."""
    for unit, size in (("s", NANOSECONDS), ("ms", 1_000_000), ("µs", 1_000)):
        if nanoseconds % size == 0 or abs(nanoseconds) >= size:
            return f"{nanoseconds / size:.9g} {unit}"
    return f"{nanoseconds} ns"


def common_cycle(periods: Iterable[int]) -> int:
    """The least common multiple of all periods."""
    return math.lcm(*periods)
