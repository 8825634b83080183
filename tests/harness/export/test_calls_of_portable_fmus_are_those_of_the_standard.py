"""A portable FMU of a plant or a controller takes each function where the standards' tables allow
it; elsewhere it says so and fails its next step, as its library turns a refusal into Fatal.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fmus.packaging.plant.build import cached_fmu
from harness.export.controller import controller_fmu
from tests.fmus.packaging.calls import everything, try_call
from tests.fmus.packaging.raw import CO_SIMULATION, DISCARD, ERROR, OK, Raw
from tests.fmus.packaging.standard import LENIENT, TABLES, Table
from tests.harness.export.blocks import counter

PLANT = {name: name for name in ("state", "output")}
BLOCK = {"state": "state.count", "output": "count"}
# What the libraries of pythonfmu and pythonfmu3 decide before any Python of ours is called, by the
# attribute that would promise it: they answer Error, or throw through C, which ends the process.
OF_THE_LIBRARY = {
    "GetDirectionalDerivative": ("providesDirectionalDerivative", ERROR),
    "GetRealOutputDerivatives": ("maxOutputDerivativeOrder", ERROR),
    "GetOutputDerivatives": ("maxOutputDerivativeOrder", ERROR),
    "GetAdjointDerivative": ("providesAdjointDerivatives", None),
}
# Read before the initialization in FMI 2: a step that fails for it would do more harm.
READ_EARLY = ("Get", "instantiated")
STEPPED = [table for table in TABLES if table.kind == CO_SIMULATION]
# A portable FMU is never in the state "failed": after a failed step it is in step mode as before.
CELLS = [
    pytest.param(kind, table, *cell, id=f"{kind}-{table.version}-{cell[0]}-{cell[1]}")
    for kind in ("plant", "block")
    for table in STEPPED
    for cell in table.cells(table.functions)
    if cell[0] not in OF_THE_LIBRARY and cell[1] != "failed"
]


@contextmanager
def instance(kind: str, version: int, state: str, folder: Path) -> Iterator[Raw]:
    path = (
        cached_fmu(everything, version, portable=True) if kind == "plant" else
        controller_fmu(counter(), "block", 0.01, version, portable=True, certified=False)
    )  # fmt: skip
    fmu = Raw(path, CO_SIMULATION, folder)
    names = PLANT if kind == "plant" else BLOCK
    fmu.references |= {one: fmu.references[name] for one, name in names.items()}
    fmu.bring_to(state)
    yield fmu
    fmu.free()


@pytest.mark.parametrize(("kind", "table", "name", "state", "allowed"), CELLS)
def test_function(
    kind: str, table: Table, name: str, state: str, allowed: bool, tmp_path: Path
) -> None:
    failed = DISCARD if table.version == 2 else ERROR
    with instance(kind, table.version, state, tmp_path) as fmu:
        status = try_call(fmu, name)
        if allowed or (name, state) in {*LENIENT, READ_EARLY}:
            assert (status, fmu.messages) == (OK, [])
            return
        assert status == (failed if name == "DoStep" else OK)
        assert fmu.messages[0][0] == ERROR and fmu.messages[0][1].startswith(f"{name}: not allowed")
        assert fmu.step(0.0, 0.01) == failed
        assert name in fmu.messages[-1][1]
        if state == "terminated":
            assert fmu.step(0.0, 0.01) == failed
            return
        if state == "instantiated":  # nothing else was changed by the refused call
            assert fmu.enter_initialization() == OK
        if state != "step":
            assert fmu.call("ExitInitializationMode") == OK
        assert fmu.step(0.0, 0.01) == OK, fmu.messages


@pytest.mark.parametrize("kind", ["plant", "block"])
@pytest.mark.parametrize("table", STEPPED, ids=["FMI 2", "FMI 3"])
def test_what_the_library_decides_is_not_promised(kind: str, table: Table, tmp_path: Path) -> None:
    with instance(kind, table.version, "step", tmp_path) as fmu:
        declared = ElementTree.parse(tmp_path / "modelDescription.xml").find(CO_SIMULATION)
        assert declared is not None
        for name in OF_THE_LIBRARY.keys() & table.functions.keys():
            attribute, status = OF_THE_LIBRARY[name]
            for one in (attribute, attribute + "s"):
                assert declared.get(one, "false") in ("false", "0")
            assert status is None or try_call(fmu, name) == status


@pytest.mark.parametrize("table", STEPPED, ids=["FMI 2", "FMI 3"])
def test_nothing_is_set_after_the_end(table: Table, tmp_path: Path) -> None:
    with instance("plant", table.version, "terminated", tmp_path) as fmu:
        assert fmu.set("input", 0.5) == OK
        assert fmu.messages[-1][1].startswith("Set: not allowed")
        assert fmu.get("input") == 0.0
