"""Items of enumerations are given by name, in start values and files, pass through wires, and have
their names in results."""

from pathlib import Path

import pytest

from harness import simulate
from harness.bench import Bench
from harness.errors import HarnessError
from harness.results.storage import read_recording
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler

NAMES = {"2": ("o_in", "o_out"), "3": ("Enumeration_in", "Enumeration_out")}


@pytest.mark.parametrize("kind", NAMES)
def test_of_a_file(tmp_path: Path, kind: str) -> None:
    given, found = NAMES[kind]
    (tmp_path / "in.csv").write_text(f'time,{given}\n0,low\n0.5,"high"\n1,7\n')
    path = tmp_path / "in.csv"
    result = simulate(model_fmu(kind), stop_time=1.0, step_size=0.25, inputs=path)
    assert result.item_names(found)[-1] == "high" and set(result[found].tolist()) == {1, 7}
    path.write_text(f"time,{given}\n0,low\n1,medium\n")
    with pytest.raises(HarnessError, match=r"medium.*7 'high'"):
        simulate(model_fmu(kind), stop_time=1.0, inputs=path)


@pytest.mark.parametrize("kind", NAMES)
def test_of_a_wire_and_a_recording(tmp_path: Path, kind: str) -> None:
    given, found = NAMES[kind]
    bench = Bench(stop_time=0.3, step=0.1)
    bench.fmu("first", model_fmu(kind), start_values={given: "high"})
    bench.fmu("second", model_fmu(kind))
    bench.connect(f"first.{found}", f"second.{given}")
    bench.run(tmp_path / "run")
    result = read_recording(tmp_path / "run")
    assert result.item_names(f"second.{found}")[-1] == "high"
    assert result.column(f"second.{found}").items == ((1, "low"), (7, "high"))
