"""Without a C compiler plants run as portable FMUs, which is said, and compute the same."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fmus.packaging.errors import PortableFallback
from fmus.plant import Plant
from tests.fmus.conformance.processes import python_path, run_python

SHARE = 1e-6
COMMAND = "from harness.cli.main import main; main()"
ARGUMENTS = ("run", "ahn2009/figure_7", "--set", "stop_time=0.5", "--variant", "pid")


@pytest.fixture
def without_compiler(tmp_path: Path) -> dict[str, str | None]:
    """An environment with an empty PATH and cache, and where `ziglang` is no compiler."""
    for name in ("bin", "cache", "hidden/ziglang"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "hidden/ziglang/__init__.py").write_text("")
    return {
        "PATH": str(tmp_path / "bin"),
        "CC": None,
        "FMU_HARNESS_CACHE": str(tmp_path / "cache"),
        "PYTHONPATH": python_path(tmp_path / "hidden"),
    }


def test_the_main_command(tmp_path: Path, without_compiler: dict[str, str | None]) -> None:
    options = {"cwd": tmp_path}
    bare = run_python(
        "-c", COMMAND, *ARGUMENTS, "--output", "bare", changed=without_compiler, **options
    )
    notice = " ".join(bare.stderr.split())
    for said in ("No C compiler found", "portable", "slower", "install a C compiler", "[zig]"):
        assert said in notice
    native = run_python(
        "-c", COMMAND, *ARGUMENTS, "--set", "fmi_version=2", "--output", "native", **options
    )
    assert "compiler" not in native.stderr
    rows = [pd.read_parquet(next((tmp_path / k).rglob("*.parquet"))) for k in ("bare", "native")]
    assert list(rows[0].columns) == list(rows[1].columns)
    span = np.ptp(rows[1].to_numpy(), axis=0)
    assert np.all(np.abs(rows[0] - rows[1]).max() <= SHARE * span)


def test_each_plant(
    plant: Plant, version: int, without_compiler: dict[str, str | None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Asked for either version, it gives its portable FMU and warns."""
    monkeypatch.setenv("PATH", str(without_compiler["PATH"]))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setitem(sys.modules, "ziglang", None)
    portable = plant.fmu(2, portable=True)
    with pytest.warns(PortableFallback, match=plant.name):
        assert plant.fmu(version) == portable
