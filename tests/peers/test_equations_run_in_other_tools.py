"""The equations of our plants (model exchange) under the solvers of other tools.

All plants: `python -m benchmarks.exports_elsewhere`.
"""

from __future__ import annotations

import pytest

from benchmarks.exports_elsewhere import Export, tried
from harness.export.plant import certified_plant_fmu


@pytest.mark.parametrize("name", ["hybrid_actuator", "oscillator_right"])
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("tool", ["casadi", "fmpy"])
def test_as_our_solver(tool: str, version: int, name: str) -> None:
    export = Export(certified_plant_fmu(name, version), "equations", "model-exchange")
    (row,) = tried(export, {tool: ""})
    assert row.agrees, row
