"""Building an instrument from a kind name and a mapping, and checking its fields, one by one.

Every fault is an `ExperimentError` of one sentence that names the kind, the key, what was
expected, what was received and the legal choices.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from numbers import Real
from typing import Any

from harness import registry
from harness.clock import LONGEST
from harness.errors import ExperimentError, nearest
from harness.instruments.source import SignalSource


def build(
    what: str, form: Any, known: Mapping[str, type[Any]], kind: str, given: Mapping[str, Any]
) -> Any:
    """An instance of the class that `known` holds for `kind`, or of that which
    "package.module:Class" names, its fields taken from `given`; it has the protocol `form`.

    `what` names the family in errors ("signal", "imperfection"). Lists become tuples.
    """
    own = isinstance(kind, str) and ":" in kind
    if not own and (not isinstance(kind, str) or kind not in known):
        raise ExperimentError(
            f"unknown {what} kind {kind!r}: {nearest(str(kind), known)} "
            "(or 'package.module:Class' for your own)"
        )
    chosen: Any = registry.named(kind, what) if own else known[kind]
    if not (isinstance(chosen, type) and dataclasses.is_dataclass(chosen)):
        raise ExperimentError(f"{what} {kind!r} must be a dataclass, got {chosen!r}")
    fields = {one.name: one for one in dataclasses.fields(chosen)}
    for key in given:
        if key not in fields:
            raise ExperimentError(f"{what} {kind!r} has no key {key!r}: {nearest(key, fields)}")
    required = [
        name for name, one in fields.items()
        if one.default is one.default_factory is dataclasses.MISSING
    ]  # fmt: skip
    missing = [name for name in required if name not in given]
    if missing:
        raise ExperimentError(
            f"{what} {kind!r} lacks {', '.join(map(repr, missing))}: its keys are "
            f"{', '.join(fields)}"
        )
    made = chosen(**{k: tuple(v) if isinstance(v, list) else v for k, v in given.items()})
    if not isinstance(made, form):
        raise ExperimentError(f"{what} {kind!r} lacks what {form.__module__}.{form.__name__} asks")
    return made


def label(owner: object) -> str:
    """How errors name an instrument: its kind."""
    return repr(getattr(owner, "kind", type(owner).__name__))


def check_number(
    owner: object,
    name: str,
    *,
    above: float = -math.inf,
    below: float = math.inf,
    at_least: float = -math.inf,
    at_most: float = math.inf,
) -> None:
    """Field `name` of `owner` is a finite number within the bounds, else `ExperimentError`."""
    value = getattr(owner, name)
    bounds = [
        f"{word} {bound:g}"
        for word, bound in (
            ("above", above),
            ("below", below),
            ("at least", at_least),
            ("at most", at_most),
        )
        if math.isfinite(bound)
    ]
    legal = is_number(value) and above < value < below and at_least <= value <= at_most
    if not legal:
        wanted = " ".join(["a finite number", " and ".join(bounds)]).strip()
        raise ExperimentError(f"{label(owner)}: {name!r} must be {wanted}, got {value!r}")


def is_number(value: object) -> bool:
    """Whether `value` is a finite real number (a bool is none)."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def check_numbers(owner: object, *names: str) -> None:
    """Each named field of `owner` is a finite number."""
    for name in names:
        check_number(owner, name)


def check_time(owner: object, name: str, *, positive: bool = False) -> None:
    """Field `name` is a time in seconds that int64 nanoseconds hold; `positive`: at least 1 ns."""
    low = 1e-9 if positive else -LONGEST
    check_number(owner, name, at_least=low, at_most=LONGEST)


def check_whole(owner: object, name: str, low: int, high: int) -> None:
    """Field `name` is a whole number from `low` to `high`."""
    value = getattr(owner, name)
    if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
        raise ExperimentError(
            f"{label(owner)}: {name!r} must be a whole number from {low} to {high}, got {value!r}"
        )


def check_choice(owner: object, name: str, *legal: str) -> None:
    """Field `name` is one of `legal`."""
    value = getattr(owner, name)
    if value not in legal:
        raise ExperimentError(
            f"{label(owner)}: {name!r} must be one of {', '.join(map(repr, legal))}, got {value!r}"
        )


def check_signal(owner: object, value: object) -> None:
    """`value` is a signal source."""
    if not isinstance(value, SignalSource):
        raise ExperimentError(
            f"{label(owner)}: a signal (a table with 'kind', or a SignalSource) was expected, "
            f"got {value!r}"
        )


def check_unit(owner: object) -> None:
    """Field `unit` is a unit string, or None for the unit of the port that is wired."""
    value = getattr(owner, "unit", None)
    if value is not None and not (isinstance(value, str) and value):
        raise ExperimentError(
            f"{label(owner)}: 'unit' must be a unit such as 'N' or 'm/s', got {value!r}"
        )


def check_one_of(owner: object, first: str, second: str) -> None:
    """Exactly one of two fields is given (the other is None)."""
    if (getattr(owner, first) is None) == (getattr(owner, second) is None):
        raise ExperimentError(
            f"{label(owner)}: give either {first!r} or {second!r}, got "
            f"{getattr(owner, first)!r} and {getattr(owner, second)!r}"
        )
