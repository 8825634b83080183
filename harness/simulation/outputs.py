"""What a simulation records: the selected variables, all types, arrays element by element.

Numbers keep their own type until they are asked for: 64-bit integers beyond 2^53 stay exact in
`SimulationResult[...]` and in the CSV file, though the columns of a Result are float64. Strings
and binaries (hexadecimal) are kept as text beside the numbers. Arrays become columns `a[1,2]`,
counted from 1 in row-major order.
"""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, nearest
from harness.fmi.groups import VariableGroup, grouped
from harness.fmi.instance import FmuInstance
from harness.fmi.model_description import ModelDescription, Variable
from harness.fmi.values import flat, native_dtype
from harness.results.columns import Column
from harness.results.manifest import Manifest
from harness.results.result import Result

_TEXT_TYPES = ("String", "Binary")


@dataclass(frozen=True, eq=False)
class SimulationResult(Result):
    """A `Result` of one FMU with what does not fit in float64.

    `texts` holds strings and binaries (hexadecimal) by column, `exact` the numbers in their own
    type, `order` all columns in the order of the file, `notes` what the run had to derive or
    leave out.
    """

    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    exact: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    order: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Any:
        """The values of one recorded name in their own type, shape (n,), or "time"."""
        if name in self.texts:
            return np.array(self.texts[name], dtype=np.str_)
        if name in self.exact:
            return self.exact[name]
        return super().__getitem__(name)

    def __contains__(self, name: object) -> bool:
        """Whether `name` was recorded."""
        return name in self.texts or super().__contains__(name)


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


def element_names(name: str, shape: tuple[int, ...]) -> list[str]:
    """The names of the columns of a variable: its own, or one for each element."""
    if not shape:
        return [name]
    places = itertools.product(*(range(1, size + 1) for size in shape))
    return [f"{name}[{','.join(map(str, place))}]" for place in places]


class Recorder:
    """Reads the selected variables of an instance, row by row, and makes the result of them."""

    def __init__(self, instance: FmuInstance, variables: Sequence[Variable]) -> None:
        """Bind the variables. Clocks, and what depends on a clock, are read when it ticks."""
        self.instance = instance
        self.variables = tuple(variables)
        self._clocked = [v for v in variables if v.type == "Clock" or v.details.clocks]
        free = [v for v in variables if v not in self._clocked]
        self._groups = grouped(instance, free)
        self._shapes = {v.name: instance.shape(v) for v in variables}
        self._held: dict[str, Any] = {v.name: _before_first_tick(v) for v in self._clocked}
        self.times: list[float] = []
        self._rows: list[list[Any]] = [[] for _ in self._groups]
        self._clocked_rows: dict[str, list[Any]] = {v.name: [] for v in self._clocked}

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
        self.times.append(time)
        for rows, values in zip(self._rows, read, strict=True):
            rows.append(values)
        for v in self._clocked:
            self._clocked_rows[v.name].append(self._held[v.name])
            if v.type == "Clock":  # a tick is one row
                self._held[v.name] = False

    def result(self, manifest: Manifest, notes: Sequence[str]) -> SimulationResult:
        """What was recorded so far."""
        units = {v.name: v for v in self.variables}
        columns, numbers, texts, exact, order = [], [], {}, {}, []
        for v, name, values in self._columns():
            order.append(name)
            if v.type in _TEXT_TYPES:
                texts[name] = tuple(one.hex() if isinstance(one, bytes) else one for one in values)
                continue
            own = np.array(values, dtype=native_dtype(v))
            own.flags.writeable = False
            if own.dtype != np.float64:
                exact[name] = own
            columns.append(Column(name, units[v.name].unit or "1", v.description))
            numbers.append(own.astype(np.float64))
        time = np.array(self.times, dtype=np.float64)
        data = np.asfortranarray(np.column_stack(numbers)) if numbers else np.empty((len(time), 0))
        return SimulationResult(
            tuple(columns), time, data, manifest, texts=texts, exact=exact, order=tuple(order),
            notes=tuple(notes),
        )  # fmt: skip

    def _columns(self) -> Iterator[tuple[Variable, str, Sequence[Any]]]:
        """Variable, column name and values, in the order in which variables were selected."""
        for v in self.variables:
            names = element_names(v.name, self._shapes[v.name])
            if v.name in self._clocked_rows:
                rows = [flat(row) for row in self._clocked_rows[v.name]]
                for i, name in enumerate(names):
                    yield v, name, [row[i] for row in rows]
                continue
            at, group = next((i, g) for i, g in enumerate(self._groups) if v.name in g.places)
            for name, column in zip(names, _slices(self._rows[at], group, v), strict=True):
                yield v, name, column


def _slices(rows: list[Any], group: VariableGroup, v: Variable) -> Iterator[Sequence[Any]]:
    place = group.places[v.name]
    for index in range(place.start, place.stop):
        yield [row[index] for row in rows]


def _before_first_tick(v: Variable) -> Any:
    if v.type == "Clock":
        return False
    blank: Any = "" if v.type == "String" else b"" if v.type == "Binary" else 0
    try:
        start = float(v.start) if v.start is not None and blank == 0 else blank
    except ValueError:
        start = blank
    return [start] * v.size
