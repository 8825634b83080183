"""A system's rows hold what an FMU's outputs are: 64-bit integers exactly, booleans as booleans."""

from pathlib import Path

import numpy as np
import pytest

from harness import Bench
from harness.results.recording import read_recording
from harness.results.result import Result
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
STARTS = {
    "Int64": 2**53 + 1, "UInt64": 2**64 - 1, "Enumeration": 7, "Int8": -128, "UInt32": 2**32 - 1,
    "Boolean": True, "Float32": 0.1,
}  # fmt: skip
DTYPES = ("int64", "uint64", "int64", "int64", "int64", "bool", "float32")


def check(result: Result) -> None:
    for (type_, value), dtype in zip(STARTS.items(), DTYPES, strict=True):
        found = result[f"p.{type_}_out"]
        assert found.dtype.name == dtype
        assert found[-1] == (np.float32(value) if type_ == "Float32" else value), type_


@pytest.mark.parametrize("in_process", [True, False])
def test_extremes_of_all_numeric_types(tmp_path: Path, in_process: bool) -> None:
    bench = Bench(stop_time=0.02, step=0.01, record=[f"p.{type_}_out" for type_ in STARTS])
    bench.fmu("p", model_fmu("3"), start_values={f"{t}_in": v for t, v in STARTS.items()})
    result = bench.run(tmp_path / "run", in_process=in_process)
    check(result)
    check(read_recording(tmp_path / "run"))
    last = (tmp_path / "run" / "results.csv").read_text().splitlines()[-1]
    assert last == "0.02,9007199254740993,18446744073709551615,7,-128,4294967295,1,0.1"
