"""The portable FMU computes what the native one computes, bit by bit, and stores its state."""

import subprocess
import sys
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from fmus.packaging import bridge
from fmus.packaging.errors import PackagingError
from fmus.packaging.plant.build import cached_fmu
from fmus.plant import Plant
from tests.fmus.packaging.plants import ALL, finite_escape, hydraulic

# pythonfmu runs the FMU inside the interpreter that loads it; a process of its own keeps what it
# leaves behind (search path, modules) out of the other tests.
COMPARE = """
import sys
import numpy as np
from fmpy import simulate_fmu
native, portable, portable_again = (
    simulate_fmu(path, fmi_type="CoSimulation", stop_time=0.5, output_interval=0.01,
                 start_values=eval(sys.argv[3]), relative_tolerance=1e-6)
    for path in (sys.argv[1], sys.argv[2], sys.argv[2])
)
for name in native.dtype.names:
    assert np.array_equal(native[name], portable[name]), name
    assert np.array_equal(native[name], portable_again[name]), name
"""
STORED = """
import sys, tempfile
from pathlib import Path
from tests.fmus.packaging.instances import load
instance = load(Path(sys.argv[1]), Path(tempfile.mkdtemp()))
instance.instantiate()
instance.initialize()
instance.set(command=100.0)
names = ["position", "velocity", "pressure_a", "force"]
instance.run(names, 10, 0.01)
stored = instance.fmu.getFMUState()
data = instance.fmu.serializeFMUState(stored)
first = instance.run(names, 10, 0.01, first=10)
instance.set(command=-50.0)
instance.fmu.setFMUState(instance.fmu.deserializeFMUState(data))
assert (instance.run(names, 10, 0.01, first=10) == first).all()
"""
FAILURE = """
import sys, tempfile
from pathlib import Path
from tests.fmus.packaging.instances import load
instance = load(Path(sys.argv[1]), Path(tempfile.mkdtemp()))
instance.instantiate(logging=True)
instance.initialize()
instance.run(["x"], 3, 0.3)
before = instance.get("time", "x")
try:
    instance.step(3, 0.3)
except Exception:
    assert instance.get("time", "x") == before
    assert any("smallest substep" in m.text for m in instance.messages), instance.messages
else:
    raise SystemExit("the step should fail")
"""


def run(script: str, *arguments: str) -> None:
    result = subprocess.run(
        [sys.executable, "-c", script, *arguments],
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("plant", ALL, ids=lambda plant: plant.name)
def test_same_numbers_also_when_loaded_twice(plant: Plant) -> None:
    inputs = {"oscillator": {"force": 3.0, "mass": 1.5}, "hydraulic": {"command": 100.0}}
    paths = [str(cached_fmu(plant, 2)), str(cached_fmu(plant, 2, portable=True))]
    run(COMPARE, *paths, repr(inputs.get(plant.name, {})))


def test_stored_state_continues_bit_equal() -> None:
    run(STORED, str(cached_fmu(hydraulic, 2, portable=True)))


def test_a_failed_step_keeps_the_state_and_says_why() -> None:
    run(FAILURE, str(cached_fmu(finite_escape, 2, portable=True)))


def test_fmi_3_without_its_bridge_is_refused_with_the_way_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(name: str) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(bridge, "distribution", missing)
    with pytest.raises(PackagingError, match=r"pip install fmu-harness\[portable3\]"):
        bridge.bridge_files("model", 3)
