"""`regions.csv` holds plain numbers, to the last bit, and an early end as nan."""

import csv
import math
from pathlib import Path

import numpy as np

from harness.experiment.experiment import Experiment
from harness.experiment.sweep import Region, write_sweep

AXIS = {"key": "components.a.parameters.value", "count": 2}
EXPERIMENT = Experiment.from_data(
    {
        "title": "a constant",
        "stop_time": 1.0,
        "components": {"a": {"signal": "constant", "parameters": {"value": 1.0}}},
        "metrics": {"size": {"kind": "rms", "signal": "a.value"}},
        "sweep": {
            "outcome": "size",
            "below": 0.5,
            "x": {**AXIS, "from": 0.0, "to": 0.3},
            "y": {**AXIS, "from": -1.0, "to": 1.0},
        },
    },
    Path("constant.toml"),
)


def test_numbers_come_back_as_they_were(tmp_path: Path) -> None:
    assert EXPERIMENT.spec.sweep is not None
    outcome = np.array([[0.1 + 0.2, 2.0 / 3.0], [math.nan, 1e-17]])
    picture, table = write_sweep(
        EXPERIMENT, {"run": Region("run", EXPERIMENT.spec.sweep, outcome)}, tmp_path
    )
    assert picture.stat().st_size > 0
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_array_equal([float(row["outcome"]) for row in rows], outcome.ravel())
    assert [float(row["x"]) for row in rows] == [0.0, 0.3, 0.0, 0.3]
    assert [float(row["y"]) for row in rows] == [-1.0, -1.0, 1.0, 1.0]
    assert [row["inside"] for row in rows] == ["1", "0", "0", "1"]
