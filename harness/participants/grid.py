"""Instants at equal distances, exact: the k-th is the double nearest to start + k * step.

Numbers are taken as they are written in decimals, so that 3 * 0.1 is 0.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction


def exact(seconds: float) -> Fraction:
    """The decimal number that prints as `seconds`."""
    return Fraction(repr(float(seconds)))


@dataclass(frozen=True)
class Grid:
    """The instants `start` + k * `step` (s), as integers over one denominator: the division of two
    integers is rounded correctly, and fast."""

    start: Fraction
    step: Fraction
    _parts: tuple[int, int, int] = field(init=False, repr=False)
    _size: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Find the common denominator."""
        whole = math.lcm(self.start.denominator, self.step.denominator)
        object.__setattr__(self, "_parts", (int(self.start * whole), int(self.step * whole), whole))
        object.__setattr__(self, "_size", float(self.step))

    @staticmethod
    def of(start: float, step: float) -> Grid:
        """The grid of two decimal numbers."""
        return Grid(exact(start), exact(step))

    @property
    def parts(self) -> tuple[int, int, int]:
        """Start and step as integers over one denominator, the third."""
        return self._parts

    def at(self, k: int) -> float:
        """The k-th instant."""
        first, step, whole = self._parts
        return (first + k * step) / whole

    def after(self, time: float) -> float:
        """The first instant later than `time`; one that `time` has missed by rounding is past."""
        k = max(0, int((time - self.at(0)) / self._size) - 1)
        at = self.at(k)
        while at <= time or is_close(at, time, self._size):
            k += 1
            at = self.at(k)
        return at

    def holds(self, time: float) -> bool:
        """Whether `time` is an instant of the grid, but for rounding."""
        k = round((time - self.at(0)) / self._size)
        return is_close(self.at(k), time, self._size)


def is_close(a: float, b: float, scale: float) -> bool:
    """Whether two instants differ by rounding only: by at most 1e-9 of `scale` (s) or
    four units in the last place."""
    return a == b or abs(a - b) <= max(1e-9 * scale, 4 * math.ulp(max(abs(a), abs(b))))
