"""What it means that a way agrees with the plain driver on a case."""

from collections.abc import Iterable, Iterator
from itertools import product
from typing import Any

import pytest

from tests.every_way.cases import Case
from tests.every_way.ways import WAYS, WIRED, Rows, by_plain_driver

_known: dict[Any, Rows] = {}


def pairs(cases: Iterable[Case]) -> Iterator[Any]:
    """Each case with each way."""
    for case, way in product(cases, WAYS):
        yield pytest.param(case, way, id=f"{case.name}-{way}")


def differences(case: Case, way: str) -> list[str]:
    """What differs, a line for each variable with its first row that does."""
    rows, wanted = WAYS[way](case), _expected(case, way in WIRED)
    assert rows.keys() == wanted.keys()
    found = []
    for name, values in rows.items():
        assert len(values) == len(wanted[name])
        assert any(value is not None for value in values)
        both = enumerate(zip(values, wanted[name], strict=True))
        wrong = [(k, got, there) for k, (got, there) in both
                 if got is not None and not _same(case, got, there)]  # fmt: skip
        found += [f"{name}: row {k} is {got}, expected {there}" for k, got, there in wrong[:1]]
    return found


def _expected(case: Case, wired: bool) -> Rows:
    """What the plain driver gives, for all ways once."""
    key = case.path, case.name, wired and bool(case.triggers)
    if key not in _known:
        _known[key] = by_plain_driver(case, wired)
    return _known[key]


def _same(case: Case, got: Any, wanted: Any) -> bool:
    if isinstance(wanted, list):
        return len(got) == len(wanted) and all(map(_same, [case] * len(got), got, wanted))
    if isinstance(wanted, bytes):
        return bool(got in (wanted, wanted.hex()))
    if isinstance(wanted, float) and not case.exact:
        return bool(abs(got - wanted) <= case.accuracy * max(1.0, abs(wanted)))
    return bool(got == wanted)
