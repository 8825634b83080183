"""The manifest says what a run was made of; the result gives arrays, a DataFrame and errors."""

import json
import platform
from pathlib import Path

import numpy as np
import pytest

from harness.errors import UsageError
from harness.results.manifest import FmuRecord, Manifest
from harness.results.recording import Column, Recording, read_recording

COLUMNS = (Column("plant.force", "N"), Column("plant.position", "m"))


def recorded(folder: Path, **known: object) -> Recording:
    recording = Recording(COLUMNS, folder, Manifest(**known))  # type: ignore[arg-type]
    recording.append(np.array([0.0, 0.01]), np.array([[1.0, 2.0], [3.0, 4.0]]))
    return recording


def test_the_manifest_is_there_while_the_run_goes_on_and_complete_after_it(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    experiment = {"stop": np.float64(1.5), "file": Path("a"), "levels": np.arange(2)}
    fmus = (FmuRecord("plant", "plant.fmu", "0f"),)
    recording = recorded(folder, fmus=fmus, seeds={"noise": 7}, experiment=experiment)
    during = json.loads((folder / "manifest.json").read_text())
    assert during["status"]["state"] == "running"
    recording.finish()
    after = json.loads((folder / "manifest.json").read_text())
    assert after["status"] == {"state": "complete", "until": 0.01, "reason": ""}
    assert after["fmus"] == [{"instance": "plant", "file": "plant.fmu", "sha256": "0f"}]
    assert after["seeds"] == {"noise": 7}
    assert after["experiment"] == {"stop": 1.5, "file": "a", "levels": [0, 1]}
    assert after["versions"]["python"] == platform.python_version()
    assert after["versions"]["numpy"] == np.__version__
    assert after["columns"][0] == {
        "name": "plant.force", "unit": "N", "description": "", "type": "real", "held": False,
        "items": [],
    }  # fmt: skip
    assert after["wall_time"] > 0
    assert read_recording(folder).manifest.fmus[0].file == "plant.fmu"


def test_a_result_gives_columns_by_name_and_the_nearest_name_otherwise(tmp_path: Path) -> None:
    result = recorded(tmp_path / "run").finish()
    assert result["plant.force"].tolist() == [1.0, 3.0]
    assert result["time"].tolist() == [0.0, 0.01]
    assert result.unit("plant.position") == "m"
    assert "plant.force" in result
    assert "plant.x" not in result
    with pytest.raises(UsageError, match=r"'plant.forse' was recorded: did you mean 'plant.force'"):
        result["plant.forse"]
    with pytest.raises(ValueError, match="read-only"):
        result["plant.force"][0] = 5.0


def test_a_dataframe_is_indexed_by_time_and_knows_units(tmp_path: Path) -> None:
    frame = recorded(tmp_path / "run").finish().dataframe()
    assert frame.index.name == "time"
    assert frame["plant.position"].to_dict() == {0.0: 2.0, 0.01: 4.0}
    assert frame.attrs["units"] == {"plant.force": "N", "plant.position": "m"}
