"""What all instruments share: made from the name of a kind and a mapping, checked field by field.

The annotation of a field says what is legal: `std: NotNegative`, `end_time: Time | None`. Every
fault is an `ExperimentError` of one sentence that names the kind, the key, what was expected, what
was received and the legal choices.
"""

from __future__ import annotations

import math
import operator
from abc import abstractmethod
from collections.abc import Callable, Container, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cache, partial
from numbers import Real
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Union, get_args, get_origin, get_type_hints

from numpy.random import SeedSequence

from harness import registry
from harness.clock import LONGEST
from harness.errors import ExperimentError, nearest
from harness.instruments.source import FunctionSampler, Sampler, SignalSource, Times, Values

_MEETS = {
    "above": operator.gt,
    "below": operator.lt,
    "at_least": operator.ge,
    "at_most": operator.le,
}


def label(owner: object) -> str:
    """How errors name an instrument: its kind."""
    return repr(getattr(owner, "kind", type(owner).__name__))


def require(owner: object, name: str, legal: bool, wanted: str, hint: str = "") -> None:
    """Raises the `ExperimentError` that field `name` must be what is `wanted`, unless `legal`."""
    if not legal:
        received = getattr(owner, name)
        raise ExperimentError(f"{label(owner)}: {name!r} must {wanted}, got {received!r}{hint}")


def is_number(value: object) -> bool:
    """Whether `value` is a finite real number (a bool is none)."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def check_number(owner: object, name: str, **bounds: float) -> None:
    """Field `name` of `owner` is a finite number within `bounds` (`above`, `below`, `at_least`,
    `at_most`), else `ExperimentError`."""
    value: Any = getattr(owner, name)
    legal = is_number(value) and all(_MEETS[word](value, one) for word, one in bounds.items())
    words = [f"{word.replace('_', ' ')} {one:g}" for word, one in bounds.items()]
    require(owner, name, legal, f"be a finite number {' and '.join(words)}".strip())


def check_numbers(owner: object, name: str) -> None:
    """Field `name` is a tuple of finite numbers."""
    value = getattr(owner, name)
    legal = isinstance(value, tuple) and all(map(is_number, value))
    require(owner, name, legal, "hold numbers")


def check_whole(owner: object, name: str, low: int, high: int) -> None:
    """Field `name` is a whole number from `low` to `high`."""
    value = getattr(owner, name)
    legal = isinstance(value, int) and not isinstance(value, bool) and low <= value <= high
    require(owner, name, legal, f"be a whole number from {low} to {high}")


def check_choice(owner: object, name: str, *, legal: tuple[str, ...]) -> None:
    """Field `name` is one of `legal`."""
    wanted = f"be one of {', '.join(map(repr, legal))}"
    require(owner, name, getattr(owner, name) in legal, wanted)


def check_order(owner: object, low: str, high: str) -> None:
    """Field `high`, where it is given, is not less than field `low`."""
    least, most = getattr(owner, low), getattr(owner, high)
    require(owner, high, most is None or most >= least, f"not be below {low!r} {least!r}")


def _check_signal(owner: object, name: str) -> None:
    given = getattr(owner, name)
    for one in given if isinstance(given, tuple) else (given,):
        if not isinstance(one, SignalSource):
            raise ExperimentError(
                f"{label(owner)}: a signal (a table with 'kind', or a SignalSource) was expected, "
                f"got {one!r}"
            )


def _check_unit(owner: object, name: str) -> None:
    value = getattr(owner, name)
    legal = value is None or (isinstance(value, str) and value != "")
    require(owner, name, legal, "be a unit such as 'N' or 'm/s'")


def check_one_of(owner: object, first: str, second: str) -> None:
    """Exactly one of two fields is given (the other is None)."""
    given = getattr(owner, first), getattr(owner, second)
    if (given[0] is None) == (given[1] is None):
        raise ExperimentError(
            f"{label(owner)}: give either {first!r} or {second!r}, got {given[0]!r} and "
            f"{given[1]!r}"
        )


Number = Annotated[float, check_number]
NotNegative = Annotated[float, partial(check_number, at_least=0.0)]
Positive = Annotated[float, partial(check_number, above=0.0)]
Probability = Annotated[float, partial(check_number, at_least=0.0, at_most=1.0)]
Time = Annotated[float, partial(check_number, at_least=-LONGEST, at_most=LONGEST)]
"""Seconds that int64 nanoseconds hold."""
Duration = Annotated[float, partial(check_number, at_least=1e-9, at_most=LONGEST)]
"""The same, at least 1 ns."""
Numbers = Annotated[tuple[float, ...], check_numbers]
OneSignal = Annotated[SignalSource, _check_signal]
Signals = Annotated[tuple[SignalSource, ...], _check_signal]
UnitName = Annotated[str | None, _check_unit]
"""A unit, None for that of the port that is wired."""


@dataclass(frozen=True)
class Instrument:
    """Data whose fields are checked when it is made; a subclass with a `kind` is known by it."""

    kind: ClassVar[str]
    kinds: ClassVar[dict[str, type[Any]]]

    def __init_subclass__(cls, kind: str = "") -> None:
        if kind:
            cls.kind = kind
            cls.kinds[kind] = cls

    def __post_init__(self) -> None:
        """Checks every field as its annotation says (None where the annotation allows it), then
        what concerns several."""
        kind: Any = type(self)
        for name, check, optional in _checks(kind):
            if not (optional and getattr(self, name) is None):
                check(self, name)
        self._settle()

    def _settle(self) -> None:
        """Checks fields against each other, and fills in what follows from others."""


@dataclass(frozen=True)
class Signal(Instrument):
    """A signal of this package; it meets `SignalSource`."""

    kinds: ClassVar[dict[str, type[Any]]] = {}
    unit: UnitName = field(default=None, kw_only=True)


class Waveform(Signal):
    """A signal without memory or chance: the values of `at` depend on their own instants only."""

    @abstractmethod
    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        return FunctionSampler(self.at)


@cache
def _checks(kind: Any) -> list[tuple[str, Callable[[object, str], None], bool]]:
    """Field, check and whether None passes, as the annotations of a class say."""
    options = {
        name: get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
        for name, hint in get_type_hints(kind, include_extras=True).items()
    }
    return [
        (name, check, NoneType in given)
        for name, given in options.items()
        for one in given
        for check in getattr(one, "__metadata__", ())
    ]


def lacking(kind: type[Any], given: Container[str]) -> list[str]:
    """The fields of a dataclass that have no default and are not `given`."""
    needed = [one.name for one in fields(kind) if one.default is one.default_factory is MISSING]
    return [name for name in needed if name not in given]


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
    if not (isinstance(chosen, type) and is_dataclass(chosen)):
        raise ExperimentError(f"{what} {kind!r} must be a dataclass, got {chosen!r}")
    keys = {one.name: one for one in sorted(fields(chosen), key=lambda one: bool(one.kw_only))}
    for key in given:
        if key not in keys:
            raise ExperimentError(f"{what} {kind!r} has no key {key!r}: {nearest(key, keys)}")
    missing = lacking(chosen, given)
    if missing:
        raise ExperimentError(
            f"{what} {kind!r} lacks {', '.join(map(repr, missing))}: its keys are {', '.join(keys)}"
        )
    made = chosen(**{k: tuple(v) if isinstance(v, list) else v for k, v in given.items()})
    if not isinstance(made, form):
        raise ExperimentError(f"{what} {kind!r} lacks what {form.__module__}.{form.__name__} asks")
    return made
