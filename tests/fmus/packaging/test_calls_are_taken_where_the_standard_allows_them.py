"""Each function and each kind of variable, in each state of FMI 2's and FMI 3's state machines."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.calls import everything, try_call
from tests.fmus.packaging.raw import CO_SIMULATION, DISCARD, ERROR, OK, Raw
from tests.fmus.packaging.standard import LENIENT, TABLES, Table

FUNCTIONS = [
    pytest.param(table, *cell, id=f"{table.version}-{table.kind}-{cell[0]}-{cell[1]}")
    for table in TABLES
    for cell in table.cells(table.functions)
]
VARIABLES = [
    pytest.param(table, *cell, id=f"{table.version}-{table.kind}-{cell[0]}-{cell[1]}")
    for table in TABLES
    for cell in table.cells(table.settable)
]
NAMES = {"derivative": "der(state)"}


@contextmanager
def instance(table: Table, state: str, folder: Path, *, portable: bool = False) -> Iterator[Raw]:
    fmu = Raw(cached_fmu(everything, table.version, portable=portable), table.kind, folder)
    fmu.bring_to(state)
    yield fmu
    fmu.free()


@pytest.mark.parametrize(("table", "name", "state", "allowed"), FUNCTIONS)
def test_function(table: Table, name: str, state: str, allowed: bool, tmp_path: Path) -> None:
    with instance(table, state, tmp_path) as fmu:
        if allowed:
            assert try_call(fmu, name) == OK, fmu.messages
        elif (name, state) not in LENIENT:
            assert try_call(fmu, name) == ERROR
            assert fmu.messages[-1][0] == ERROR


@pytest.mark.parametrize(("table", "name", "state", "allowed"), VARIABLES)
def test_variable(table: Table, name: str, state: str, allowed: bool, tmp_path: Path) -> None:
    with instance(table, state, tmp_path) as fmu:
        variable = NAMES.get(name, name)
        readable = state != "instantiated" or table.version == 3
        before = fmu.get(variable) if readable else None
        if allowed:
            assert fmu.set(variable, 1.5) == OK, fmu.messages
        elif (name, state) not in LENIENT:
            assert fmu.set(variable, 1.5) == ERROR
        if readable and (allowed or (name, state) not in LENIENT):
            assert fmu.get(variable) == (1.5 if allowed else before)


PORTABLE = [
    pytest.param(table, *cell, id=f"{table.version}-{cell[0]}-{cell[1]}")
    for table in TABLES
    for cell in table.cells(table.settable)
    if table.kind == CO_SIMULATION and cell[1] in ("initialization", "step")
]


@pytest.mark.parametrize(("table", "name", "state", "allowed"), PORTABLE)
def test_variable_of_a_portable_fmu(
    table: Table, name: str, state: str, allowed: bool, tmp_path: Path
) -> None:
    """Its library turns each refusal into Fatal, so the next step fails in its place."""
    variable = NAMES.get(name, name)
    with instance(table, state, tmp_path, portable=True) as fmu:
        before = fmu.get(variable)
        assert fmu.set(variable, 0.5) == OK
        assert fmu.get(variable) == (0.5 if allowed else before)
        if state == "initialization":
            assert fmu.call("ExitInitializationMode") == OK
        expected = OK if allowed else DISCARD if table.version == 2 else ERROR
        assert fmu.step(0.0, 0.01) == expected, fmu.messages
        assert allowed or variable in fmu.messages[-1][1]
