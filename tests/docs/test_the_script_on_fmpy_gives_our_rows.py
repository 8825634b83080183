"""The script that the page on speed compares with is a run of the lead experiment, bit for bit."""

import subprocess
from pathlib import Path

from benchmarks import lead_script


def test_its_rows_are_ours(tmp_path: Path) -> None:
    command = lead_script.prepared(tmp_path)
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert done.stdout.startswith("RMS of the error after 6 s: ")
    assert lead_script.difference(tmp_path) == 0.0
    for name in ("response.png", "disturbance.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    rows = (tmp_path / "results.csv").read_text()
    (tmp_path / "results.csv").write_text(rows.replace("2000.0,19", "2000.0,20"))
    assert lead_script.difference(tmp_path) > 0.0
