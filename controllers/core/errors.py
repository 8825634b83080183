"""The one exception of this package: parameters that cannot be meant.

A step function never raises; every fault is found when a controller or estimator is described.
"""

from __future__ import annotations

import math
from collections.abc import Iterable


class ControllerError(Exception):
    """A controller or estimator described with values that cannot be meant."""


def require(condition: bool, where: str, expected: str, received: object) -> None:
    """Raise `ControllerError` in the house form unless `condition` holds."""
    if not condition:
        raise ControllerError(f"{where}: expected {expected}, received {received!r}.")


def require_finite(where: str, value: float) -> None:
    """Raise `ControllerError` unless `value` is a finite number."""
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    require(number and math.isfinite(value), where, "a finite number", value)


def require_positive(where: str, value: float) -> None:
    """Raise `ControllerError` unless `value` is finite and greater than zero."""
    require_finite(where, value)
    require(value > 0.0, where, "a number greater than 0", value)


def require_not_negative(where: str, value: float) -> None:
    """Raise `ControllerError` unless `value` is finite and not below zero."""
    require_finite(where, value)
    require(value >= 0.0, where, "a number not below 0", value)


def require_choice(where: str, value: object, legal: Iterable[object]) -> None:
    """Raise `ControllerError` unless `value` is one of `legal`."""
    choices = tuple(legal)
    require(value in choices, where, "one of " + ", ".join(map(repr, choices)), value)
