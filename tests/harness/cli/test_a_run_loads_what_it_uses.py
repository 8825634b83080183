"""A run that is written and drawn loads no library that only studies, designs or packages need."""

import subprocess
import sys
from pathlib import Path

UNUSED = {"pandas", "scipy.optimize", "scipy.stats", "pyarrow.dataset", "harness.ssp.package"}
PROGRAM = """
import sys
from harness.cli.main import run_command_line
name = "ahn2009/figure_11"
assert run_command_line(["run", name, "--variant", "robust_ekf", "--output", sys.argv[1]]) == 0
print(*sys.modules, file=sys.stderr)
"""


def test_a_run_loads_what_it_uses(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(folder)],
        capture_output=True, text=True, check=True, timeout=300,
    )  # fmt: skip
    assert (folder / "robust_ekf" / "results.parquet").is_file()
    assert (folder / "response.png").is_file()
    assert not UNUSED & set(ran.stderr.split())
