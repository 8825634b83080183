"""A simulation against a reference file: the band by default, and which columns are held."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.errors import UsageError
from harness.fmi.description.model_description import REAL_TYPES, ModelDescription, Variable
from harness.results.result import Result
from harness.simulation.comparison import Agreement, Band, compare
from harness.simulation.csv_files import read_reference
from harness.simulation.outputs import element_names


def validate(
    d: ModelDescription,
    result: Result,
    path: Path,
    time_band: float | None = None,
    value_band: float = 0.01,
) -> tuple[tuple[Agreement, ...], Band]:
    """Compare `result` with the CSV file at `path`; the agreements and the band that was used.

    Where no `time_band` (s) is given it is the larger of the usual distances of the rows of both,
    since an event may be seen that much later.
    """
    shapes = {name: _shape(result, v) for name, v in d.variables.items() if v.dimensions}
    reference = read_reference(path, shapes)
    if not reference.columns:
        raise UsageError(f"{path} has no column but the time")
    if time_band is None:
        time_band = max(_spacing(result.time), _spacing(reference.time))
    elif not (np.isfinite(time_band) and time_band >= 0.0):
        raise UsageError(f"the time band must not be negative, not {time_band} s")
    held = {
        element: not _interpolated(v)
        for name, v in d.variables.items()
        for element in element_names(name, shapes.get(name, ()))
    }
    band = Band(time_band, value_band)
    return compare(result, reference, band, held), band


def _spacing(time: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    gaps = np.diff(time)
    gaps = gaps[gaps > 0.0]
    return float(np.median(gaps)) if gaps.size else 0.0


def _interpolated(v: Variable) -> bool:
    return v.type in REAL_TYPES and v.variability == "continuous"


def _shape(result: Result, v: Variable) -> tuple[int, ...]:
    """The sizes of a recorded array, from the names of its columns."""
    places = [
        tuple(map(int, name[len(v.name) + 1 : -1].split(",")))
        for name in result.order
        if name.startswith(f"{v.name}[") and name.endswith("]")
    ]
    return tuple(max(axis) for axis in zip(*places, strict=True)) if places else ()
