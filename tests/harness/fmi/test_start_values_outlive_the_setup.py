"""An FMU of FMI 2 that begins anew in fmi2SetupExperiment has the start values all the same."""

from pathlib import Path

import pytest

from harness import simulate
from tests.harness.inspection.liars import liar
from tests.harness.simulation.fmus import needs_compiler


@needs_compiler
@pytest.mark.parametrize("fault", ["FORGETS", "LEAK"])
def test_an_input_keeps_its_start_value(tmp_path: Path, fault: str) -> None:
    given = {"start_values": {"u": 1.0}, "stop_time": 1.0, "step_size": 0.1}
    assert simulate(liar(tmp_path, fault), **given)["y"][-1] > 0.1  # type: ignore[arg-type]
