"""What the plan chose for the user stands in the manifest, in this process and in a worker."""

from pathlib import Path

import pytest

from harness.bench import Bench
from harness.results.manifest import read_manifest


@pytest.mark.parametrize("in_process", [False, True])
def test_a_note_on_rates(tmp_path: Path, in_process: bool) -> None:
    bench = Bench(stop_time=0.1, step=0.01)
    bench.fmu("left", "oscillator_left")
    bench.controller("spring", lambda time, x: -x, sample_time=0.007)
    bench.connect("left.position", "spring.x")
    bench.connect("spring.u", "left.coupling_force", convert_units=False)
    (note,) = bench.run(tmp_path / "run", in_process=in_process).manifest.notes
    assert note.startswith("spring runs every 7 ms and left steps by 10 ms")
    assert read_manifest(tmp_path / "run").notes == (note,)
