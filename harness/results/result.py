"""The result of a run as arrays, as a DataFrame and as a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from harness.display import html_table
from harness.errors import UsageError, nearest
from harness.results.columns import TIME, Column, Values
from harness.results.manifest import Manifest, RunStatus

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """What a run recorded: a column for each of `columns`, and the `time`.

    `values` has the n values of each name, "time" among them: numbers as an array of the column's
    own type (read-only), strings and binaries (hexadecimal) as a tuple of texts. Those of a long
    run in a folder are read from its file when they are asked for (`storage.StoredColumns`).
    `metrics` by name, `folder` None for a run kept in memory, `notes` what a simulation had to
    derive or leave out. At an event a time repeats: the row before it, then that after it.
    """

    columns: tuple[Column, ...]
    values: Mapping[str, Values]
    manifest: Manifest = field(default_factory=Manifest)
    folder: Path | None = None
    metrics: Mapping[str, float | None] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """One line: how many rows and columns, until when, how it ended, where it is."""
        n = len(self.time)
        span = f", t = {self.time[0]:g} … {self.time[-1]:g} s" if n else ""
        place = "" if self.folder is None else f", in {self.folder}"
        return f"<Result: {n} rows{span}, {len(self.columns)} columns, {self.status}{place}>"

    def _repr_html_(self) -> str:
        """The signals, each with how far it went, and the metrics."""
        signals = [(name, self.unit(name), *self._extent(name)) for name in self.names]
        heads = ("signal", "unit", "first", "least", "greatest", "last")
        shown = html_table(repr(self).strip("<>"), heads, signals)
        found = [(k, "–" if v is None else f"{v:.6g}") for k, v in self.metrics.items()]
        return shown + (html_table("metrics", ("metric", "value"), found) if found else "")

    def _extent(self, name: str) -> tuple[str, ...]:
        if self.column(name).dtype is None or not len(self.time):
            return ("", "", "", "")
        values = self.numbers(name)
        return tuple(f"{v:.6g}" for v in (values[0], values.min(), values.max(), values[-1]))

    @property
    def time(self) -> Array:
        """Times (s, shape (n,))."""
        return self.numbers(TIME)

    @property
    def data(self) -> Array:
        """The columns that are numbers, as float64 (shape (n, m), made anew at each call): booleans
        and ticks of clocks as 0 and 1, 64-bit integers rounded."""
        numbers = [self.numbers(name) for name in self.numeric]
        return np.array(numbers, np.float64).reshape(len(numbers), len(self.time)).T

    @property
    def status(self) -> RunStatus:
        """How the run ended."""
        return self.manifest.status

    @property
    def names(self) -> tuple[str, ...]:
        """The recorded names in the order of the files, without `time`."""
        return tuple(column.name for column in self.columns)

    @property
    def numeric(self) -> tuple[str, ...]:
        """The names of the columns that are numbers."""
        return tuple(column.name for column in self.columns if column.dtype is not None)

    @cached_property
    def _columns(self) -> dict[str, Column]:
        return {column.name: column for column in self.columns}

    def __getitem__(self, name: str) -> Any:
        """The values of one recorded name in their own type, shape (n,), or "time"."""
        if name != TIME and self.column(name).dtype is None:
            return np.array(self.values[name], dtype=np.str_)
        return self.values[name]

    def __contains__(self, name: object) -> bool:
        """Whether `name` was recorded."""
        return name == TIME or name in self._columns

    def numbers(self, name: str) -> Array:
        """The values of one recorded name as float64, shape (n,)."""
        if name != TIME and (column := self.column(name)).dtype is None:
            raise UsageError(f"{name!r} was recorded as {column.type}, where numbers were expected")
        values = np.asarray(self.values[name], dtype=np.float64)
        values.flags.writeable = False
        return values

    def item_names(self, name: str) -> list[str]:
        """The values of an enumeration by the names of its items; a number that is none as such."""
        items = dict(self.column(name).items)
        return [items.get(int(number), str(number)) for number in self[name]]

    def column(self, name: str) -> Column:
        """The column called `name`; raises `UsageError` where it was not recorded."""
        if name not in self._columns:
            raise UsageError(
                f"nothing called {name!r} was recorded: {nearest(name, self._columns)}"
            )
        return self._columns[name]

    def unit(self, name: str) -> str:
        """The unit of one recorded name."""
        return "s" if name == TIME else self.column(name).unit

    @property
    def not_finite(self) -> tuple[str, ...]:
        """One phrase for each column that has NaN or infinity."""
        phrases = []
        for name in self.numeric:
            values = self.numbers(name)
            rows = np.flatnonzero(~np.isfinite(values))
            if rows.size:
                at = f"{values[rows[0]]} at t = {self.time[rows[0]]:.9g} s"
                phrases.append(f"{name} is {at}, the first of {rows.size} such rows")
        return tuple(phrases)

    def dataframe(self) -> pd.DataFrame:
        """A pandas DataFrame, one column a name in its own type, indexed by time (s); units in
        `attrs["units"]`."""
        import pandas as pd

        values = ((name, self.values[name]) for name in self.names)
        held = {name: list(v) if isinstance(v, tuple) else v.copy() for name, v in values}
        frame = pd.DataFrame(held, index=pd.Index(self.time, name=TIME))
        frame.attrs["units"] = {column.name: column.unit for column in self.columns}
        return frame

    def plot(self, *names: str, title: str = "") -> Figure:
        """The named signals over time (all numbers where none is named), one panel a unit."""
        from harness.results.plots import signals_plot

        return signals_plot(self, names or self.numeric, title=title)
