"""Which ways are expected to agree with the plain driver on a case, and what agreeing means."""

from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from tests.every_way.cases import Case
from tests.every_way.not_yet import reason
from tests.every_way.ways import WAYS, Rows, by_plain_driver

_known: dict[Any, Rows] = {}


def pairs(cases: Iterable[Case]) -> Iterator[Any]:
    """Each case with each way; those of `not_yet` are expected to fail."""
    for case in cases:
        for way in WAYS:
            why = reason(way, case.needs)
            marks = [pytest.mark.xfail(reason=why, strict=True)] if why else []
            yield pytest.param(case, way, marks=marks, id=f"{case.name}-{way}")


def differences(case: Case, way: str) -> list[str]:
    """What differs, a line for each variable with its first row that does."""
    rows, wanted = WAYS[way](case), _expected(case)
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


def _expected(case: Case) -> Rows:
    """What the plain driver gives, for all ways once."""
    key = case.path, case.name
    if key not in _known:
        _known[key] = by_plain_driver(case)
    return _known[key]


def _same(case: Case, got: Any, wanted: Any) -> bool:
    if isinstance(wanted, list):
        return len(got) == len(wanted) and all(map(_same, [case] * len(got), got, wanted))
    if isinstance(wanted, bytes):
        return bool(got in (wanted, wanted.hex()))
    if isinstance(wanted, float) and not case.exact:
        return bool(abs(got - wanted) <= case.accuracy * max(1.0, abs(wanted)))
    return bool(got == wanted)
