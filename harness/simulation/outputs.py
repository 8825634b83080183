"""What a simulation records: the selected variables, all types, arrays element by element.

Arrays become columns `a[1,2]`, counted from 1 in row-major order. A variable that is called `time`
becomes the column `instance.time`, as in a system.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from harness.errors import UsageError, nearest
from harness.fmi.binding.groups import grouped
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import flat
from harness.fmi.description.model_description import ModelDescription, Variable
from harness.results.columns import TIME, Column, bare_name, check_columns, element_names
from harness.results.manifest import Manifest
from harness.results.result import Result

Content = tuple[list[float], list[list[Any]], dict[str, list[Any]]]
_COLUMN_TYPES = {
    "Real": "real", "Float64": "real", "Float32": "float32", "Boolean": "boolean",
    "Clock": "clock", "Int64": "int64", "UInt64": "uint64", "Enumeration": "int64",
    "String": "text", "Binary": "binary",
}  # fmt: skip


def select(d: ModelDescription, patterns: Sequence[str] | None) -> tuple[Variable, ...]:
    """The variables to record: those that match one of `patterns` (exact names, or with * and
    ?), or the outputs, or the states of an FMU without outputs, or else its local variables.
    Raises `UsageError` for a pattern that matches nothing."""
    kept = [v for v in d.variables.values() if v.causality != "independent"]
    if patterns is None:
        states = {name for name, _ in d.states}
        for chosen in (
            [v for v in kept if v.causality == "output"],
            [v for v in kept if v.name in states],
            [v for v in kept if v.causality == "local" and v.variability != "constant"],
        ):
            if chosen:
                return tuple(chosen)
        return tuple(kept)
    found: dict[str, Variable] = {}
    for pattern in patterns:
        exact = d.variables.get(pattern)
        matching = [exact] if exact is not None else _matching(kept, pattern)
        if not matching:
            raise UsageError(
                f"nothing to record matches {pattern!r}: {nearest(pattern, [v.name for v in kept])}"
            )
        found |= {v.name: v for v in matching if v.causality != "independent"}
    return tuple(found.values())


def _matching(variables: Sequence[Variable], pattern: str) -> list[Variable]:
    literal = pattern.replace("[", "[[]")  # brackets are part of names here
    return [v for v in variables if fnmatch.fnmatchcase(v.name, literal)]


@dataclass
class Rows:
    """Rows as they were read: a block of numbers or texts for each group of variables. It holds
    nothing of an instance but its name, so it may go to another process."""

    instance: str
    variables: tuple[Variable, ...]
    shapes: dict[str, tuple[int, ...]]
    places: list[dict[str, slice]]
    times: list[float] = field(default_factory=list)
    blocks: list[list[Any]] = field(default_factory=list)
    clocked: dict[str, list[Any]] = field(default_factory=dict)

    def take(self) -> Rows:
        """What is there so far, and nothing of it is kept."""
        taken = replace(self)
        self.times = []
        self.blocks = [[] for _ in self.blocks]
        self.clocked = {name: [] for name in self.clocked}
        return taken

    @property
    def content(self) -> Content:
        """The rows without what is the same for all of them."""
        return self.times, self.blocks, self.clocked

    def extend(self, more: Content) -> None:
        """Append rows of the same variables."""
        times, blocks, clocked = more
        self.times += times
        for mine, theirs in zip(self.blocks, blocks, strict=True):
            mine += theirs
        for name, values in clocked.items():
            self.clocked[name] += values

    def result(self, manifest: Manifest, notes: Sequence[str]) -> Result:
        """The rows as a result."""
        columns, read = [], []
        for v, name, values in self._columns():
            known = bare_name(self.instance, name), v.unit or "1", v.description
            held = v.variability != "continuous"
            column = Column(*known, _COLUMN_TYPES.get(v.type, "integer"), held)
            columns.append(column)
            read.append(values if column.dtype is None else np.array(values, column.dtype))
        time = np.array(self.times, dtype=np.float64)
        result = Result.of(check_columns(columns), time, read, manifest)
        if any(v.name == TIME for v in self.variables):
            name = bare_name(self.instance, TIME)
            notes = [*notes, f"the variable 'time' was recorded as {name!r}"]
        return replace(result, notes=tuple(notes))

    def _columns(self) -> Iterator[tuple[Variable, str, Sequence[Any]]]:
        """Variable, column name and values, in the order in which variables were selected."""
        for v in self.variables:
            names = element_names(v.name, self.shapes[v.name])
            if v.name in self.clocked:
                rows, first = [flat(row) for row in self.clocked[v.name]], 0
            else:
                at = next(i for i, places in enumerate(self.places) if v.name in places)
                rows, first = self.blocks[at], self.places[at][v.name].start
            for index, name in enumerate(names, start=first):
                yield v, name, [row[index] for row in rows]


class Recorder:
    """Reads the selected variables of an instance, row by row; `rows` holds them."""

    def __init__(self, instance: FmuInstance, variables: Sequence[Variable]) -> None:
        """Bind the variables. Clocks, and what depends on a clock, are read when it ticks."""
        self.instance = instance
        self._clocked = [v for v in variables if v.type == "Clock" or v.details.clocks]
        self._groups = grouped(instance, [v for v in variables if v not in self._clocked])
        self._held: dict[str, Any] = {v.name: _before_first_tick(v) for v in self._clocked}
        self.last: float | None = None
        self.rows = Rows(
            instance.name,
            tuple(variables),
            {v.name: instance.shape(v) for v in variables},
            [group.places for group in self._groups],
            blocks=[[] for _ in self._groups],
            clocked={v.name: [] for v in self._clocked},
        )

    @property
    def clocked_names(self) -> set[str]:
        """The recorded variables that depend on clocks, and the recorded clocks."""
        return {v.name for v in self._clocked}

    def hold(self, active: Mapping[str, bool]) -> None:
        """Read what depends on the clocks that are active now; to be called in event mode."""
        for v in self._clocked:
            if v.type == "Clock":
                self._held[v.name] = active.get(v.name, False)
            elif any(active.get(clock, False) for clock in v.details.clocks):
                self._held[v.name] = self.instance.get(v.name)

    def record(self, time: float) -> None:
        """Read and keep a row at `time` (s)."""
        read = [group.read() for group in self._groups]
        self.last = time
        self.rows.times.append(time)
        for block, values in zip(self.rows.blocks, read, strict=True):
            block.append(values)
        for v in self._clocked:
            self.rows.clocked[v.name].append(self._held[v.name])
            if v.type == "Clock":  # a tick is one row
                self._held[v.name] = False


def _before_first_tick(v: Variable) -> Any:
    if v.type == "Clock":
        return False
    blank: Any = "" if v.type == "String" else b"" if v.type == "Binary" else 0
    try:
        start = float(v.start) if v.start is not None and blank == 0 else blank
    except ValueError:
        start = blank
    return [start] * v.size
