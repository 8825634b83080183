"""An output of which an FMU lists no dependencies follows its inputs, except in co-simulation of
FMI 1, where outputs are computed in steps."""

from pathlib import Path

import pytest

from harness.fmi.fmu import Fmu
from harness.master.plan.order import feeding_inputs
from harness.system.graph import Endpoint
from tests.every_way.descriptions import Model, Variable, fmi1, fmi2
from tests.every_way.models import needs_compiler, pack

pytestmark = needs_compiler
MODEL = Model("table", (Variable("y", 1), Variable("u", 2, causality="input", start="0")),
              ("co-simulation",))  # fmt: skip


@pytest.mark.parametrize("version", [1, 2])
def test_the_inputs_behind_an_output(version: int, tmp_path: Path) -> None:
    text = {1: fmi1(MODEL, "co-simulation"), 2: fmi2(MODEL)}[version]
    path = pack(tmp_path / "y.fmu", MODEL, version, text, "-DSCALARS")
    with Fmu(path) as fmu:
        found = feeding_inputs(Endpoint("f", "y"), {"f": fmu.description})
    assert found == (frozenset() if version == 1 else {Endpoint("f", "u")})
