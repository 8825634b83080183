"""An FMU's output `time` is recorded as `instance.time`, beside the column `time` of the clock."""

import csv
import zipfile
from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.errors import RecordingError
from harness.results.csv_files import write_csv
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler


def renamed(folder: Path, **names: str) -> Path:
    """The model of FMI 2 with other names of variables, called `model`."""
    path = folder / "renamed.fmu"
    with zipfile.ZipFile(model_fmu("2")) as source, zipfile.ZipFile(path, "w") as target:
        for member in source.namelist():
            content = source.read(member)
            if member == "modelDescription.xml":
                for old, new in names.items():
                    content = content.replace(f'name="{old}"'.encode(), f'name="{new}"'.encode())
            target.writestr(member, content)
    return path


def test_both_are_in_the_result_and_in_the_file(tmp_path: Path) -> None:
    plain = simulate(model_fmu("2"), stop_time=0.5, step_size=0.1)
    result = simulate(renamed(tmp_path, h="time"), stop_time=0.5, step_size=0.1)
    name = f"{result.manifest.fmus[0].instance}.time"
    assert np.array_equal(result[name], plain["h"]) and result.unit(name) == "m"
    assert np.array_equal(result["time"], plain.time) and result.unit("time") == "s"
    assert f"the variable 'time' was recorded as {name!r}" in result.notes
    write_csv(result, tmp_path / "out.csv")
    with (tmp_path / "out.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["time", *result.names] and len(set(header)) == len(header)
    assert [float(row[header.index(name)]) for row in rows] == plain["h"].tolist()


def test_a_second_variable_of_that_name_is_refused_in_one_sentence(tmp_path: Path) -> None:
    path = model_fmu("2")
    instance = simulate(path, stop_time=0.1, step_size=0.1).manifest.fmus[0].instance
    path = renamed(tmp_path, h="time", v=f"{instance}.time")
    with pytest.raises(RecordingError, match=rf"columns are called '{instance}\.time'; rename one"):
        simulate(path, stop_time=0.1, step_size=0.1)
