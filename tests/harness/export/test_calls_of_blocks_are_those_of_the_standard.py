"""A block's FMU takes each call where the standards' tables allow it, and refuses the others."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from harness.export.controller import controller_fmu
from tests.fmus.packaging.calls import try_call
from tests.fmus.packaging.raw import CO_SIMULATION, DISCARD, ERROR, OK, Raw
from tests.fmus.packaging.standard import LENIENT, TABLES, Table
from tests.harness.export.blocks import counter

# variables of `counter` by the kinds of the tables; its outputs and states are `initial` exact
KINDS = {"input": "u", "output": "count", "state": "state.count",
         "tunable": "parameters.increment", "time": "time"}  # fmt: skip
NOT_OFFERED = {"GetDirectionalDerivative", "GetAdjointDerivative", "GetOutputDerivatives",
               "GetRealOutputDerivatives"}  # fmt: skip
STEPPED = [table for table in TABLES if table.kind == CO_SIMULATION]


def cells(rows: str) -> list[object]:
    return [
        pytest.param(table, *cell, id=f"{table.version}-{cell[0]}-{cell[1]}")
        for table in STEPPED
        for cell in table.cells(getattr(table, rows))
        if cell[0] not in NOT_OFFERED and cell[1] != "failed"
        and (rows == "functions" or cell[0] in KINDS)
    ]  # fmt: skip


@contextmanager
def instance(table: Table, state: str, folder: Path, *, portable: bool = False) -> Iterator[Raw]:
    path = controller_fmu(
        counter(), "block", 0.01, table.version, portable=portable, certified=False
    )
    fmu = Raw(path, CO_SIMULATION, folder)
    fmu.references |= {kind: fmu.references[name] for kind, name in KINDS.items()}
    fmu.bring_to(state)
    yield fmu
    fmu.free()


@pytest.mark.parametrize(("table", "name", "state", "allowed"), cells("functions"))
def test_function(table: Table, name: str, state: str, allowed: bool, tmp_path: Path) -> None:
    with instance(table, state, tmp_path) as fmu:
        if (name, state) not in LENIENT:
            assert try_call(fmu, name) == (OK if allowed else ERROR), fmu.messages


@pytest.mark.parametrize(("table", "name", "state", "allowed"), cells("settable"))
def test_variable(table: Table, name: str, state: str, allowed: bool, tmp_path: Path) -> None:
    allowed = allowed or (name == "output" and state in ("instantiated", "initialization"))
    with instance(table, state, tmp_path) as fmu:
        if (name, state) not in LENIENT:
            assert fmu.set(name, 1.5) == (OK if allowed else ERROR), fmu.messages


@pytest.mark.parametrize("table", STEPPED, ids=["FMI 2", "FMI 3"])
@pytest.mark.parametrize("name", KINDS)
def test_variable_of_a_portable_fmu_in_step_mode(table: Table, name: str, tmp_path: Path) -> None:
    with instance(table, "step", tmp_path, portable=True) as fmu:
        assert fmu.set(name, 1.5) == OK
        allowed = name in ("input", "tunable")
        assert fmu.step(0.0, 0.01) == (OK if allowed else ERROR if table.version == 3 else DISCARD)
