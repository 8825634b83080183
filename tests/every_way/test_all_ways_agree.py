"""An FMU gives the same rows, whichever way it is run: to the bit in co-simulation and scheduled
execution, to the tolerance of the solver in model exchange."""

from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest

from tests.every_way.cases import CASES, Case
from tests.every_way.models import needs_compiler
from tests.every_way.not_yet import reason
from tests.every_way.ways import WAYS, Rows, by_plain_driver

pytestmark = needs_compiler
SOLVER = 1e-6
"""Times the size of the value: what the solvers, at 1e-10, and the bounces make of it."""


@cache
def expected(name: str) -> Rows:
    return by_plain_driver(CASES[name])


def pairs() -> Iterator[Any]:
    for case in CASES.values():
        for way in WAYS:
            why = reason(way, case.needs)
            marks = [pytest.mark.xfail(reason=why, strict=True)] if why else []
            yield pytest.param(case.name, way, marks=marks, id=f"{case.name}-{way}")


def same(case: Case, got: Any, wanted: Any) -> bool:
    if isinstance(wanted, list):
        return len(got) == len(wanted) and all(map(same, [case] * len(got), got, wanted))
    if isinstance(wanted, bytes):
        return bool(got in (wanted, wanted.hex()))
    if isinstance(wanted, float) and not case.exact:
        return bool(abs(got - wanted) <= SOLVER * max(1.0, abs(wanted)))
    return bool(got == wanted)


@pytest.mark.parametrize(("name", "way"), list(pairs()))
def test_the_rows_are_those_of_the_plain_driver(name: str, way: str) -> None:
    case, wanted = CASES[name], expected(name)
    rows = WAYS[way](case)
    assert rows.keys() == wanted.keys()
    for variable, values in rows.items():
        assert len(values) == len(wanted[variable])
        assert any(value is not None for value in values)
        wrong = [
            (row, got, there)
            for row, (got, there) in enumerate(zip(values, wanted[variable], strict=True))
            if got is not None and not same(case, got, there)
        ]
        assert not wrong, f"{variable}: (row, got, expected) {wrong[:3]}"
