"""Instants at equal distances, exact: the k-th is the double nearest to start + k * step.

Numbers are taken as they are written in decimals, so that 3 * 0.1 is 0.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction


def exact(seconds: float) -> Fraction:
    """The decimal number that prints as `seconds`."""
    return Fraction(repr(float(seconds)))


@dataclass(frozen=True)
class Grid:
    """The instants `start` + k * `step` (s)."""

    start: Fraction
    step: Fraction

    @staticmethod
    def of(start: float, step: float) -> Grid:
        """The grid of two decimal numbers."""
        return Grid(exact(start), exact(step))

    def at(self, k: int) -> float:
        """The k-th instant."""
        return float(self.start + k * self.step)

    def after(self, time: float) -> float:
        """The first instant later than `time`; one that `time` has missed by rounding is past."""
        k = math.floor((Fraction(time) - self.start) / self.step)
        k = max(k, 0) if time >= self.start else 0
        while self.at(k) <= time or is_close(self.at(k), time, float(self.step)):
            k += 1
        return self.at(k)

    def holds(self, time: float) -> bool:
        """Whether `time` is an instant of the grid, but for rounding."""
        k = round((Fraction(time) - self.start) / self.step)
        return is_close(self.at(k), time, float(self.step))


def is_close(a: float, b: float, scale: float) -> bool:
    """Whether two instants differ by rounding only: by at most 1e-9 of `scale` (s) or
    four units in the last place."""
    return abs(a - b) <= max(1e-9 * scale, 4 * math.ulp(max(abs(a), abs(b))))
