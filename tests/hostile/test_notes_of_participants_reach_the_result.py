"""What FMUs had to have done otherwise stands in the manifest of the run, once, however it ends."""

from pathlib import Path

import pytest

from harness.errors import SimulationError
from harness.results.manifest import read_manifest
from tests.hostile.worlds import bench

STARTS = {"T": 0.7}


@pytest.mark.parametrize("in_process", [False, True])
@pytest.mark.parametrize("fmi", [2, 3])
def test_what_terminate_returned(tmp_path: Path, in_process: bool, fmi: int) -> None:
    made = bench(tmp_path, "Terminate error", fmi=fmi)
    result = made.run(tmp_path / "run", in_process=in_process)
    (note,) = result.manifest.notes
    assert "plant" in note and f"fmi{fmi}Terminate returned Error" in note
    assert read_manifest(tmp_path / "run").notes == (note,)
    assert made.run(in_process=in_process).manifest.notes == (note,)


@pytest.mark.parametrize("ending", ["DoStep segfault 50", "DoStep error 50", "DoStep ok"])
def test_start_values_beyond_their_limits(tmp_path: Path, ending: str) -> None:
    """Notes that were there before a crash survive it."""
    from tests.harness.fmi.archives import rewritten
    from tests.hostile.build import description

    document = description(3).replace('start="0.1"', 'start="0.1" max="0.5"').encode()
    made = bench(tmp_path, ending)
    path = tmp_path / "limited.fmu"
    rewritten(tmp_path / "hostile.fmu", path, modelDescription_dot_xml=document)
    del made._components["plant"]
    made.fmu("plant", path, start_values=STARTS, validate=False)
    if ending != "DoStep ok":
        with pytest.raises(SimulationError):
            made.run(tmp_path / "run")
    else:
        made.run(tmp_path / "run")
    (note,) = read_manifest(tmp_path / "run").notes
    assert "start value of 'T' is 0.7, above its max 0.5" in note
