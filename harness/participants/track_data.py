"""Reading inputs: the columns of a CSV file, or numbers, functions and arrays from Python.

An array takes one column with its elements separated by spaces, or a column an element, named
"u[1,2]". A triggered clock takes a column of 0 and 1: it ticks at every row with a 1. Columns that
are no inputs are left out with a note.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import HarnessError, UsageError, nearest
from harness.fmi.binding.values import flat, parse_value
from harness.fmi.description.model_description import ModelDescription, Variable
from harness.fmi.start_values import find_target, place_of
from harness.instruments.csv_signal import CsvTable, plain_name, read_csv_table
from harness.participants.tracks import Inputs, Track
from harness.system.check import is_writable

InputData = str | os.PathLike[str] | Mapping[str, Any]


def read_inputs(d: ModelDescription, data: InputData | None, notes: list[str]) -> Inputs:
    """The inputs that `data` stands for: the path of a CSV file, or a mapping from names to
    numbers, functions of time, or pairs (times, values). `d` has the sizes of arrays in force."""
    if data is None:
        return Inputs()
    if isinstance(data, (str, os.PathLike)):
        return Inputs(_from_table(d, read_csv_table(Path(data), as_text=True), notes))
    return Inputs([_from_python(_input(d, name), value) for name, value in data.items()])


def _input(d: ModelDescription, name: str) -> Variable:
    variable = d.variables.get(name)
    if variable is None or not is_writable(variable):
        legal = [v.name for v in d.variables.values() if is_writable(v)]
        what = "there is none in the FMU" if variable is None else f"it is {_role(variable)}"
        raise UsageError(
            f"{name!r} cannot be given over time: {what}; inputs and tunable parameters can: "
            f"{nearest(name, legal)}"
        )
    return variable


def _role(v: Variable) -> str:
    return f"a {v.variability} {v.causality}" if v.causality != "output" else "an output"


def _from_python(v: Variable, value: Any) -> Track:
    if callable(value):
        return Track(v, function=value)
    if isinstance(value, tuple) and len(value) == 2 and np.ndim(value[0]) == 1:
        times = tuple(float(t) for t in value[0])
        rows = tuple(tuple(flat(row)) for row in value[1])
        if len(times) != len(rows) or not times:
            raise UsageError(
                f"input {v.name!r} has {len(times)} times and {len(rows)} values; as many of both "
                "are needed, and at least one"
            )
        _check_times(f"input {v.name!r}", times)
    else:
        times, rows = (0.0,), (tuple(flat(value)),)
    short = next((row for row in rows if len(row) != v.size), None)
    if short is not None:
        raise UsageError(
            f"input {v.name!r} has {v.size} element(s), but a row of {len(short)} was given"
        )
    return Track(v, times, rows)


def _check_times(what: str, times: Sequence[float]) -> None:
    values: NDArray[np.float64] = np.asarray(times, dtype=np.float64)
    if not np.all(np.isfinite(values)):
        raise UsageError(f"{what} has a time that is not finite")
    back = np.flatnonzero(np.diff(values) < 0)
    if back.size:
        i = int(back[0])
        raise UsageError(
            f"{what}: time goes back from {times[i]!r} s to {times[i + 1]!r} s; times must not "
            "decrease"
        )


def _from_table(d: ModelDescription, table: CsvTable, notes: list[str]) -> list[Track]:
    times = tuple(table.seconds.tolist())
    columns: dict[str, list[Any]] = {}
    elements: dict[str, dict[int, list[Any]]] = {}
    for index, header in enumerate(table.names):
        name = header if header in d.variables else plain_name(header)
        if index == table.time_index or name.lower() == "time":
            continue
        cells = table.columns.column(index).to_pylist()
        found, element = find_target(d, name) or (None, None)
        if found is not None and element is not None:
            try:
                place = place_of(_input(d, found.name), element)
            except ValueError as fault:
                raise UsageError(f"{table.path}: column {header!r} {fault}") from fault
            cells = [one for (one,) in _rows(table, header, found, cells, 1)]
            elements.setdefault(found.name, {})[place] = cells
        elif found is None or not is_writable(found):
            role = "no variable of the FMU" if found is None else _role(found)
            notes.append(f"column {header!r} of {table.path} is left out: it is {role}")
        else:
            columns[name] = _rows(table, header, found, cells, found.size)
    for name, parts in elements.items():
        needed = d.variables[name].size
        if set(parts) != set(range(needed)):
            raise UsageError(
                f"{table.path} has {len(parts)} columns for {name!r}, which has {needed} elements"
            )
        columns[name] = list(zip(*(parts[i] for i in range(needed)), strict=True))
    if not columns:
        raise UsageError(
            f"{table.path} has no column for an input or a tunable parameter of {d.name}"
        )
    return [Track(d.variables[n], times, tuple(map(tuple, rows))) for n, rows in columns.items()]


def _rows(
    table: CsvTable, header: str, v: Variable, cells: Sequence[str | None], count: int
) -> list[Sequence[Any]]:
    """The values of a column, row by row; numbers must be finite."""
    rows = []
    for i, cell in enumerate(cells):
        try:
            rows.append(_cell(v, cell, count))
        except HarnessError as fault:
            place = f"{table.path}, column {header!r}, row {i + 1} of the values"
            raise UsageError(f"{place}: {fault}") from fault
    return rows


def _cell(v: Variable, cell: str | None, count: int) -> Sequence[Any]:
    if cell is None or (not cell.strip() and v.type not in ("String", "Binary")):
        raise UsageError("the cell is empty")
    alone = count == 1 and not v.dimensions
    row = (parse_value(v, cell),) if alone else tuple(flat(parse_value(v, cell.strip(), count)))
    if not all(math.isfinite(one) for one in row if isinstance(one, float)):
        raise UsageError(f"{cell.strip()} is not finite; inputs must be")
    return row
