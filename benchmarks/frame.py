"""What a case consists of, and how all sides of all cases are measured in turn.

A comparison has sides, each of which gives one number a round. In a round every side of every
comparison runs once, so whatever disturbs the machine disturbs all of them; ratios are taken within
a round. The first round warms caches and is thrown away.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path


class RefusedError(Exception):
    """A side is not there, or did not do what it was asked to; its words."""


@dataclass(frozen=True)
class Side:
    """`measure` gives one number, or raises `RefusedError`. One that takes minutes runs in at most
    `rounds` rounds, and is not warmed up."""

    measure: Callable[[], float]
    rounds: int = 0


@dataclass(frozen=True)
class Aim:
    """What the project wants of a comparison: the median of `side`, over that of `against` in the
    same round where one is named (with `above`, less it), is at most `bound`. `limit` says what is
    in the way where it is not, and what it would take."""

    row: str
    side: str
    bound: float
    limit: str
    against: str = ""
    above: bool = False


@dataclass(frozen=True)
class Comparison:
    """Sides that do the same work, by name, in `unit`. Shown are ratios to `baseline`, if named.
    Where the sides are sizes of one thing, `axis` says what of, and `sizes` how many."""

    name: str
    title: str
    unit: str
    sides: Mapping[str, Side]
    baseline: str = ""
    aims: tuple[Aim, ...] = ()
    axis: str = ""
    sizes: tuple[float, ...] = ()
    note: str = ""


@dataclass
class Found:
    """The numbers of a comparison by side, None for a round that a side had no part in, and the
    words of the sides that refused."""

    comparison: Comparison
    rounds: dict[str, list[float | None]] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)

    def values(self, side: str) -> list[float]:
        """The numbers of one side."""
        return [value for value in self.rounds[side] if value is not None]

    def pairs(self, side: str, against: str) -> list[tuple[float, float]]:
        """The numbers of two sides in the rounds that both had part in."""
        both = zip(self.rounds[side], self.rounds[against], strict=True)
        return [(a, b) for a, b in both if a is not None and b is not None]

    def ratios(self, side: str, against: str) -> list[float]:
        """One over the other, round by round."""
        return [a / b for a, b in self.pairs(side, against)]

    def figures(self, aim: Aim) -> list[float]:
        """What an aim speaks of, round by round; empty where a side refused."""
        if {aim.side, aim.against or aim.side} & self.refused.keys():
            return []
        if not aim.against:
            return self.values(aim.side)
        if aim.above:
            return [a - b for a, b in self.pairs(aim.side, aim.against)]
        return self.ratios(aim.side, aim.against)


@dataclass(frozen=True)
class Setting:
    """What cases are made in: a `folder` for their files, the `peers` to ask, and what is to be
    undone in the end."""

    folder: Path
    peers: tuple[str, ...]
    undo: ExitStack


Case = Callable[[Setting], Iterable[Comparison]]


def middle(values: Sequence[float]) -> str:
    """Median and spread, in three digits."""
    if not values:
        return "–"
    if len(values) == 1:
        return number(values[0])
    low, high = number(min(values)), number(max(values))
    return f"{number(statistics.median(values))} ({low} to {high})"


def number(value: float) -> str:
    """Three digits, without an exponent where it is no long number."""
    return f"{value:.0f}" if 1000.0 <= abs(value) < 1e6 else f"{value:.3g}"


def measure(
    comparisons: Sequence[Comparison], rounds: int, say: Callable[[str], None]
) -> list[Found]:
    """All sides in turn, `rounds` times and once to warm up; `say` is told where it is."""
    found = [Found(one, {name: [] for name in one.sides}) for one in comparisons]
    for number in range(rounds + 1):
        for one in found:
            for name, side in one.comparison.sides.items():
                say(f"round {number} of {rounds}: {one.comparison.name}, {name}")
                _once(one, name, side, number)
    return found


def _once(found: Found, name: str, side: Side, number: int) -> None:
    """One side in the round with that number, 0 to warm up."""
    takes_part = number <= side.rounds and number > 0 if side.rounds else True
    value = None
    if takes_part and name not in found.refused:
        try:
            value = side.measure()
        except RefusedError as refusal:
            found.refused[name] = str(refusal)
        except Exception as fault:  # the other sides have been measured for minutes
            found.refused[name] = " ".join(f"{type(fault).__name__}: {fault}".split())[:300]
    if number > 0:
        found.rounds[name].append(value)
