"""Inputs over time: from a CSV file, arrays, numbers or functions, for inputs and tunables.

A continuous input (of a floating type) is interpolated linearly between its rows; everything else
is held. Where a time repeats, the first row holds before it and the last one after it: that is a
discontinuity, and so is every change of a value that is held. Before the first row the first one
holds, after the last row the last one. Functions of time are called with the time in seconds and
have no discontinuities that this module knows of.

An array takes one column with its elements separated by spaces, or a column an element, named
"u[1,2]". A triggered clock takes a column of 0 and 1: it ticks at every row with a 1.
"""

from __future__ import annotations

import math
import os
import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import SimulationError, UsageError, nearest
from harness.fmi.instance import FmuInstance
from harness.fmi.model_description import REAL_TYPES, ModelDescription, Variable
from harness.fmi.values import flat, parse_value
from harness.instruments.csv_signal import CsvTable, plain_name, read_csv_table

Function = Callable[[float], Any]
InputData = str | os.PathLike[str] | Mapping[str, Any]
_ELEMENT = re.compile(r"^(.*)\[(\d+(?:\s*,\s*\d+)*)\]$")


@dataclass(frozen=True)
class Track:
    """The values of one variable over time: rows at `times` (s, not decreasing), or a function."""

    variable: Variable
    times: tuple[float, ...] = ()
    rows: tuple[tuple[Any, ...], ...] = ()
    function: Function | None = None

    @property
    def continuous(self) -> bool:
        """Whether the values are interpolated and may be set at any time."""
        return self.variable.type in REAL_TYPES and self.variable.variability == "continuous"

    def before(self, time: float) -> Sequence[Any]:
        """The values just before `time`."""
        return self._at(time, bisect_left(self.times, time))

    def after(self, time: float) -> Sequence[Any]:
        """The values at `time` and just after it."""
        return self._at(time, bisect_right(self.times, time))

    def _at(self, time: float, upper: int) -> Sequence[Any]:
        if self.function is not None:
            return self._computed(self.function, time)
        if upper == 0:  # a row at this very time is reached from the left
            return self.rows[0]
        if upper == len(self.times) or not self.continuous:
            return self.rows[upper - 1]
        left, right = self.times[upper - 1], self.times[upper]
        if right == left:
            return self.rows[upper]
        share = (time - left) / (right - left)
        pairs = zip(self.rows[upper - 1], self.rows[upper], strict=True)
        return [a if share == 0.0 else b if share == 1.0 else a + share * (b - a) for a, b in pairs]

    def _computed(self, function: Function, time: float) -> Sequence[Any]:
        try:
            return flat(function(time))
        except Exception as fault:
            name = self.variable.name
            raise SimulationError(
                f"the function of input {name!r} failed at t = {time:.9g} s: {fault!r}"
            ) from fault

    def events(self) -> set[float]:
        """Times of discontinuities."""
        pairs = zip(self.times[:-1], self.times[1:], self.rows[:-1], self.rows[1:], strict=True)
        if self.continuous:
            return {t1 for t0, t1, row0, row1 in pairs if t0 == t1 and row0 != row1}
        return {t1 for _, t1, row0, row1 in pairs if row0 != row1}

    def kinks(self) -> set[float]:
        """Times between which the values are smooth."""
        return set(self.times) if self.continuous and len(self.times) > 1 else set()


class Inputs:
    """All tracks of a simulation; `next_event` and `next_kink` look ahead."""

    def __init__(self, tracks: Sequence[Track] = ()) -> None:
        """Sort the tracks into continuous ones, held ones and clocks."""
        self.clocks = {t.variable.name: t for t in tracks if t.variable.type == "Clock"}
        values = [t for t in tracks if t.variable.type != "Clock"]
        self.continuous = [t for t in values if t.continuous]
        self.held = [t for t in values if not t.continuous]
        self._events = sorted(set().union(*(t.events() for t in values)) if values else ())
        kinks = set(self._events).union(*(t.kinks() for t in values))
        self._kinks = sorted(kinks)
        self._written: dict[str, Any] = {}

    @property
    def has_functions(self) -> bool:
        """Whether a value is computed by a function, whose jumps nobody knows."""
        return any(t.function is not None for t in (*self.continuous, *self.held))

    def next_event(self, time: float) -> float:
        """The first discontinuity later than `time` (s), or infinity."""
        i = bisect_right(self._events, time)
        return self._events[i] if i < len(self._events) else math.inf

    def next_kink(self, time: float) -> float:
        """The first discontinuity of the values or their slopes later than `time`, or infinity."""
        i = bisect_right(self._kinks, time)
        return self._kinks[i] if i < len(self._kinks) else math.inf

    def apply_continuous(self, instance: FmuInstance, time: float, *, after: bool) -> None:
        """Set the continuous inputs."""
        for track in self.continuous:
            self._write(instance, track, track.after(time) if after else track.before(time))

    def apply(self, instance: FmuInstance, time: float, *, after: bool = True) -> None:
        """Set everything that is not yet as it should be."""
        self.apply_continuous(instance, time, after=after)
        for track in self.held:
            self._write(instance, track, track.after(time) if after else track.before(time))

    def _write(self, instance: FmuInstance, track: Track, values: Sequence[Any]) -> None:
        name = track.variable.name
        if self._written.get(name) == values:
            return
        one = values[0] if not track.variable.dimensions and len(values) == 1 else list(values)
        instance.set({name: one})
        self._written[name] = values

    def forget(self) -> None:
        """What was set is no longer known, as after a return to an earlier state."""
        self._written.clear()


def read_inputs(
    d: ModelDescription, data: InputData | None, notes: list[str], count: Callable[[Variable], int]
) -> Inputs:
    """The inputs that `data` stands for: the path of a CSV file, or a mapping from names to
    numbers, functions of time, or pairs (times, values). `count` gives the sizes of arrays."""
    if data is None:
        return Inputs()
    if isinstance(data, (str, os.PathLike)):
        return Inputs(_from_table(d, read_csv_table(Path(data), as_text=True), notes, count))
    return Inputs([_from_python(_input(d, name), value, count) for name, value in data.items()])


def _input(d: ModelDescription, name: str) -> Variable:
    variable = d.variables.get(name)
    if variable is None or not settable(variable):
        legal = [v.name for v in d.variables.values() if settable(v)]
        what = "there is none in the FMU" if variable is None else f"it is {_role(variable)}"
        raise UsageError(
            f"{name!r} cannot be given over time: {what}; inputs and tunable parameters can: "
            f"{nearest(name, legal)}"
        )
    return variable


def settable(v: Variable) -> bool:
    """Whether a variable may change during the run by the user's will."""
    tunable = v.variability == "tunable" and v.causality in ("parameter", "structuralParameter")
    return v.causality == "input" or (tunable and v.causality == "parameter")


def _role(v: Variable) -> str:
    return f"a {v.variability} {v.causality}" if v.causality != "output" else "an output"


def _from_python(v: Variable, value: Any, count: Callable[[Variable], int]) -> Track:
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
    needed = count(v)
    short = next((row for row in rows if len(row) != needed), None)
    if short is not None:
        raise UsageError(
            f"input {v.name!r} has {needed} element(s), but a row of {len(short)} was given"
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


def _from_table(
    d: ModelDescription, table: CsvTable, notes: list[str], count: Callable[[Variable], int]
) -> list[Track]:
    times = time_column(table)
    columns: dict[str, list[Any]] = {}
    elements: dict[str, dict[int, list[Any]]] = {}
    for index, header in enumerate(table.names):
        name = header if header in d.variables else plain_name(header)
        if index == _time_index(table) or name.lower() == "time":
            continue
        cells = table.columns.column(index).to_pylist()
        found = d.variables.get(name)
        match = _ELEMENT.match(name)
        if found is None and match and match[1] in d.variables:
            v = _input(d, match[1])
            place = _place(v, match[2], count)
            elements.setdefault(v.name, {})[place] = [_cell(table, v, c, 1)[0] for c in cells]
        elif found is None or not settable(found):
            role = "no variable of the FMU" if found is None else _role(found)
            notes.append(f"column {header!r} of {table.path} is left out: it is {role}")
        else:
            columns[name] = [_cell(table, found, cell, count(found)) for cell in cells]
    for name, parts in elements.items():
        needed = count(d.variables[name])
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


def _place(v: Variable, text: str, count: Callable[[Variable], int]) -> int:
    sizes = [size for size in v.dimensions if isinstance(size, int)]
    index = [int(one) - 1 for one in text.split(",")]
    if len(index) == 1:
        return index[0]
    if len(sizes) != len(index):
        raise UsageError(
            f"elements of {v.name!r} cannot be given by column, since its sizes are structural "
            "parameters; give one column with the elements separated by spaces"
        )
    return int(np.ravel_multi_index(index, sizes))


def _cell(table: CsvTable, v: Variable, cell: str | None, count: int) -> Sequence[Any]:
    if cell is None or (not cell.strip() and v.type not in ("String", "Binary")):
        raise UsageError(f"{table.path}: column {v.name!r} has an empty cell")
    if count == 1 and not v.dimensions:
        return (parse_value(v, cell),)
    return flat(parse_value(v, cell.strip(), count))


def _time_index(table: CsvTable) -> int:
    for index, name in enumerate(table.names):
        if plain_name(name).lower() == "time":
            return index
    raise UsageError(
        f"{table.path} has no column 'time', only {', '.join(map(repr, table.names[:12]))}"
    )


def time_column(table: CsvTable) -> tuple[float, ...]:
    """The times (s) of a table that was read as text; raises `UsageError`."""
    cells = table.columns.column(_time_index(table)).to_pylist()
    try:
        times = tuple(float(cell) for cell in cells)
    except (TypeError, ValueError) as fault:
        raise UsageError(f"{table.path}: a cell of the column 'time' is no number") from fault
    if not times:
        raise UsageError(f"{table.path} has a header but no rows of values")
    _check_times(str(table.path), times)
    return times
