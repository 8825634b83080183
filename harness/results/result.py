"""The result of a run as arrays, as a DataFrame and as a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, nearest
from harness.results.columns import TIME, Column
from harness.results.manifest import Manifest, RunStatus

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Result:
    """What a run recorded: `time` (s, shape (n,)) and a column for each of `columns`.

    `data` (float64, shape (n, m)) holds the m columns that are numbers, in their order: booleans
    and ticks of clocks as 0 and 1, 64-bit integers rounded. `exact` has the numbers that are not
    float64 in their own type by name, `texts` strings and binaries (hexadecimal). Arrays are
    read-only. `metrics` by name, `folder` None for a run kept in memory, `notes` what a simulation
    had to derive or leave out. At an event a time repeats: the row before it, then that after it.
    """

    columns: tuple[Column, ...]
    time: Array
    data: Array
    manifest: Manifest = field(default_factory=Manifest)
    folder: Path | None = None
    metrics: Mapping[str, float | None] = field(default_factory=dict)
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    exact: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        columns: tuple[Column, ...],
        time: Array,
        values: Sequence[NDArray[Any] | Sequence[str | bytes]],
        manifest: Manifest,
    ) -> Result:
        """The result of `values` by column, as many as `time` has: arrays of the column's dtype,
        texts and binaries as they are."""
        texts: dict[str, tuple[str, ...]] = {}
        exact: dict[str, NDArray[Any]] = {}
        numbers: list[NDArray[Any]] = []
        for column, own in zip(columns, values, strict=True):
            if column.dtype is None:
                texts[column.name] = tuple(t.hex() if isinstance(t, bytes) else t for t in own)
                continue
            numbers.append(np.asarray(own))
            if column.type != "real":
                exact[column.name] = numbers[-1]
        data = np.array(numbers, dtype=np.float64).reshape(len(numbers), len(time)).T
        return cls(columns, time, data, manifest, texts=texts, exact=exact)

    def __post_init__(self) -> None:
        """Closes the arrays for writing."""
        if self.data.shape != (len(self.time), len(self._index)):
            raise UsageError(
                f"a result of {len(self.time)} rows and {len(self._index)} columns of numbers got "
                f"data of shape {self.data.shape}"
            )
        for array in (self.time, self.data, *self.exact.values()):
            array.flags.writeable = False

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
        """The names of the columns of `data`."""
        return tuple(self._index)

    @cached_property
    def _columns(self) -> dict[str, Column]:
        return {column.name: column for column in self.columns}

    @cached_property
    def _index(self) -> dict[str, int]:
        numbers = [column.name for column in self.columns if column.dtype is not None]
        return {name: index for index, name in enumerate(numbers)}

    def __getitem__(self, name: str) -> Any:
        """The values of one recorded name in their own type, shape (n,), or "time"."""
        if name in self.texts:
            return np.array(self.texts[name], dtype=np.str_)
        return self.exact[name] if name in self.exact else self.numbers(name)

    def __contains__(self, name: object) -> bool:
        """Whether `name` was recorded."""
        return name == TIME or name in self._columns

    def numbers(self, name: str) -> Array:
        """The values of one recorded name as float64, shape (n,): its column of `data`."""
        if name == TIME:
            return self.time
        column = self.column(name)
        if column.dtype is None:
            raise UsageError(f"{name!r} was recorded as {column.type}, where numbers were expected")
        return self.data[:, self._index[name]]

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
        odd = {name: np.flatnonzero(~np.isfinite(self.numbers(name))) for name in self._index}
        return tuple(
            f"{name} is {self.numbers(name)[rows[0]]} at t = {self.time[rows[0]]:.9g} s, the first "
            f"of {rows.size} such rows"
            for name, rows in odd.items()
            if rows.size
        )

    def dataframe(self) -> pd.DataFrame:
        """A pandas DataFrame, one column a name in its own type, indexed by time (s); units in
        `attrs["units"]`."""
        import pandas as pd

        held = {name: list(self.texts[name]) if name in self.texts else self[name].copy()
                for name in self.names}  # fmt: skip
        frame = pd.DataFrame(held, index=pd.Index(self.time, name=TIME))
        frame.attrs["units"] = {column.name: column.unit for column in self.columns}
        return frame

    def plot(self, *names: str, title: str = "") -> Figure:
        """The named signals over time (all numbers where none is named), one panel a unit."""
        from harness.results.plots import signals_plot

        return signals_plot(self, names or self.numeric, title=title)
