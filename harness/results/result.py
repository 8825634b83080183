"""The result of a run as arrays, as a DataFrame and as a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, nearest
from harness.results.columns import Column
from harness.results.manifest import Manifest, RunStatus

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Result:
    """What a run recorded: `time` (s, shape (n,)), `data` (shape (n, m)) one column each of
    `columns`; both read-only. `metrics` by name, `folder` None for a run kept in memory."""

    columns: tuple[Column, ...]
    time: Array
    data: Array
    manifest: Manifest = field(default_factory=Manifest)
    folder: Path | None = None
    metrics: Mapping[str, float | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Closes the arrays for writing."""
        if self.data.shape != (len(self.time), len(self.columns)):
            raise UsageError(
                f"a result of {len(self.time)} rows and {len(self.columns)} columns got data of "
                f"shape {self.data.shape}"
            )
        self.time.flags.writeable = False
        self.data.flags.writeable = False

    @property
    def status(self) -> RunStatus:
        """How the run ended."""
        return self.manifest.status

    @property
    def names(self) -> tuple[str, ...]:
        """The recorded names, without `time`."""
        return tuple(column.name for column in self.columns)

    @cached_property
    def _index(self) -> dict[str, int]:
        return {name: index for index, name in enumerate(self.names)}

    def _place(self, name: str) -> int:
        if name not in self._index:
            raise UsageError(f"nothing called {name!r} was recorded: {nearest(name, self._index)}")
        return self._index[name]

    def __getitem__(self, name: str) -> Array:
        """The values of one recorded name, shape (n,), or "time"."""
        return self.time if name == "time" else self.data[:, self._place(name)]

    def __contains__(self, name: object) -> bool:
        """Whether `name` was recorded."""
        return name == "time" or name in self._index

    def unit(self, name: str) -> str:
        """The unit of one recorded name."""
        return "s" if name == "time" else self.columns[self._place(name)].unit

    def with_metrics(self, metrics: Mapping[str, float | None]) -> Result:
        """The same result with these metrics."""
        return replace(self, metrics=dict(metrics))

    def dataframe(self) -> pd.DataFrame:
        """A pandas DataFrame, one column a name, indexed by time (s); units in `attrs["units"]`."""
        import pandas as pd

        frame = pd.DataFrame(
            self.data.copy(), columns=list(self.names), index=pd.Index(self.time, name="time")
        )
        frame.attrs["units"] = {column.name: column.unit for column in self.columns}
        return frame

    def plot(self, *names: str, title: str = "") -> Figure:
        """The named signals over time (all where none is named), one panel a unit."""
        from harness.results.plots import signals_plot

        return signals_plot(self, names or self.names, title=title)
