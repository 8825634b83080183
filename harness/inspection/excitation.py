"""How the inputs of an FMU under examination move: a little, and the same way in every run.

A fault that needs a moving input shows only where one moves. Real inputs, also those of arrays,
wave about their start values; booleans are toggled; integers and enumerations step through a few
of the values that the FMU declares as legal. What has no declared range and is no real number stays
as it is, as do strings, binaries and clocks: any other value of a mode or a name may be illegal.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sin

import numpy as np

from harness.fmi.binding.values import flat, parse_value
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.participants.tracks import Inputs, Track

_MOVE = 0.05  # of an input's scale
_HOLD = 3  # steps between the changes of what is no real number
_CHOICES = 5  # legal values of an integer that are tried


def moving_inputs(d: ModelDescription, start: float, step: float) -> Inputs:
    """The inputs of `d` as functions of time (s), constant within each step of size `step`."""
    moving = ((v, _values(v, index)) for index, v in enumerate(d.inputs))
    return Inputs(
        [Track(v, function=_in_steps(f, start, step)) for v, f in moving if f is not None]
    )


def _in_steps(
    values: Callable[[int], list[float]], start: float, step: float
) -> Callable[[float], list[float]]:
    return lambda time: values(int(np.floor((time - start) / step + 1e-6)))


def _values(v: Variable, index: int) -> Callable[[int], list[float]] | None:
    """The elements of an input by the number of the step; None where it must not move."""
    if v.details.clocks or v.details.alias_of:
        return None
    if v.type in REAL_TYPES:
        starts = starts_of(v)
        return lambda k: [
            within(v, start + _MOVE * (abs(v.nominal or 0.0) or abs(start) or 1.0) * wave)
            for place, start in enumerate(starts)
            for wave in (sin(0.3 * k + index + 1 + 0.5 * place),)
        ]
    choices = _choices(v)
    if len(choices) < 2:
        return None
    at = {choice: place for place, choice in enumerate(choices)}
    first = [at.get(start, 0) for start in starts_of(v)]
    return lambda k: [choices[(place + k // _HOLD) % len(choices)] for place in first]


def _choices(v: Variable) -> list[float]:
    """Legal values of an input that is no real number."""
    if v.type == "Boolean":
        return [False, True]
    if v.type not in INTEGER_TYPES:
        return []
    if v.details.items:
        return [number for number, _ in v.details.items[:_CHOICES]]
    if v.minimum is None or v.maximum is None:
        return []
    low, high, start = int(v.minimum), int(v.maximum), int(starts_of(v)[0])
    return list(range(max(low, start - 2), min(high, start + 2) + 1))


def starts_of(v: Variable) -> list[float]:
    """The start values of the elements of a numeric variable, 0 where it has none."""
    given = flat(parse_value(v, v.start, v.size)) if v.start else [0]
    return given * v.size if len(given) == 1 else given


def scale_of(v: Variable) -> float:
    """A size that is no trifle and no extreme for a real variable."""
    return abs(v.nominal or 0.0) or abs(starts_of(v)[0]) or 1.0


def within(v: Variable, value: float) -> float:
    """`value` brought into the declared range of a variable."""
    low = -np.inf if v.minimum is None else v.minimum
    high = np.inf if v.maximum is None else v.maximum
    return float(min(max(value, low), high))
