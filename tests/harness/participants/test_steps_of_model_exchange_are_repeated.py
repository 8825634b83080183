"""Two halves of an oscillator, coupled by repetition of each step: solved by us as model exchange,
which returns to its states at the start of the step, or by themselves in co-simulation, the motion
is the same but for the tolerance of the solvers."""

from pathlib import Path

import numpy as np
import pytest

from harness import Bench, Result
from harness.registry import plant_fmu
from tests.harness.fmi.archives import member, rewritten
from tests.harness.simulation.fmus import needs_compiler

pytestmark = needs_compiler
TOLERANCE = 1e-9
MOST = 100 * TOLERANCE
"""As many steps of the solvers, a tolerance each, as a hundred communication steps take at least;
the motion is of the order of 1."""


def motion(kind: str, algorithm: str, version: int, folder: Path | None = None) -> Result:
    """A second of it, at communication steps of 10 ms; with a `folder`, of FMUs that cannot store
    their state."""
    bench = Bench(stop_time=1.0, step=0.01, algorithm=algorithm, fmi_version=version)
    for side, position in (("left", 0.5), ("right", -1.0)):
        plant: Path | str = f"oscillator_{side}"
        if folder is not None:
            plant = stateless(side, version, folder)
        bench.fmu(side, plant, interface_type=kind, tolerance=TOLERANCE,
                  start_values={"position": position})  # fmt: skip
    bench.connect("left.position", "right.left_position")
    bench.connect("left.velocity", "right.left_velocity")
    bench.connect("right.coupling_force", "left.coupling_force")
    return bench.run(in_process=True)


def stateless(side: str, version: int, folder: Path) -> Path:
    """An FMU that says that it cannot store its state."""
    source = plant_fmu(f"oscillator_{side}", version)
    xml = member(source, "modelDescription.xml")
    flag = b"canGetAndSetFMUstate" if version == 2 else b"canGetAndSetFMUState"
    without = xml.replace(flag + b'="true"', flag + b'="false"')
    without = without.replace(b'canSerializeFMUstate="true"', b"")
    without = without.replace(b'canSerializeFMUState="true"', b"")
    assert without.count(flag + b'="false"') == xml.count(flag + b'="true"') > 0
    return rewritten(source, folder / f"{side}.fmu", modelDescription_dot_xml=without)


@pytest.mark.parametrize("version", [2, 3])
def test_it_is_that_of_co_simulation(version: int) -> None:
    here, itself = (
        motion(kind, "iterative", version) for kind in ("model-exchange", "co-simulation")
    )
    for name in itself.names:
        size = np.abs(itself[name]).max()
        assert size > 0.1
        assert np.abs(here[name] - itself[name]).max() <= MOST * max(1.0, size)


def test_without_repetition_it_is_another_one() -> None:
    """So the steps have been repeated."""
    repeated, once = (motion("model-exchange", a, 3) for a in ("iterative", "jacobi"))
    difference = np.abs(repeated["left.position"] - once["left.position"]).max()
    assert difference > 1000 * MOST


@pytest.mark.parametrize("version", [2, 3])
def test_states_and_time_serve_where_there_is_nothing_else(version: int, tmp_path: Path) -> None:
    """To the bit, and a note says so."""
    stored = motion("model-exchange", "iterative", version)
    without = motion("model-exchange", "iterative", version, tmp_path)
    for name in stored.names:
        assert np.array_equal(stored[name], without[name])
    assert any("cannot store its state" in note for note in without.manifest.notes)
