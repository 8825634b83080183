"""An FMU that calls exit() does not set off what the caller's process has prepared for its end."""

from __future__ import annotations

from pathlib import Path

from tests.fmus.conformance.processes import run_python
from tests.hostile.build import hostile_fmu

SCRIPT = """
import ctypes, os, sys
from harness import Bench
from harness.errors import SimulationError

path, trace = sys.argv[1:]

@ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.c_void_p)
def prepared(status, argument):
    os.close(os.open(trace, os.O_CREAT | os.O_WRONLY))

ctypes.CDLL(None).on_exit(prepared, None)
bench = Bench(stop_time=0.5)
bench.fmu("plant", path)
bench.record = ("plant.y",)
try:
    bench.run()
except SimulationError as fault:
    print(fault, flush=True)
os._exit(0)
"""


def test_nothing_of_the_caller_is_run(tmp_path: Path) -> None:
    fmu = hostile_fmu(tmp_path, "DoStep exit 5 7")
    trace = tmp_path / "trace"
    said = run_python("-c", SCRIPT, fmu, trace).stdout
    assert "ended the process as by exit(7)" in said
    assert not trace.exists()
