"""CSV files of results: strict writing, liberal reading.

Written: comma, the first column "time", names in double quotes exactly as in the XML, booleans 0
and 1, enumerations as numbers, integers in full, floating numbers in the fewest digits (at most
17) that read back to the same bits, strings in double quotes, binaries as hexadecimal digits; no
unit row.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.instruments.csv_signal import plain_name, read_csv_table
from harness.simulation.input_data import time_column
from harness.simulation.outputs import element_names


@dataclass(frozen=True)
class ReferenceTable:
    """A trajectory to compare with: `time` (s, shape (n,)), `columns` of text by name."""

    path: Path
    time: NDArray[np.float64]
    columns: dict[str, tuple[str, ...]]

    def numbers(self, name: str) -> NDArray[np.float64] | None:
        """A column as numbers (true and false as 1 and 0), None where it holds text."""
        words = {"true": "1", "false": "0"}
        try:
            return np.array([float(words.get(c.lower(), c)) for c in self.columns[name]])
        except ValueError:
            return None


def read_reference(path: Path, arrays: dict[str, tuple[int, ...]]) -> ReferenceTable:
    """The table at `path`, read liberally; raises `HarnessError`. Columns of whole arrays (sizes
    in `arrays`), their elements separated by spaces, become a column an element."""
    table = read_csv_table(path, as_text=True)
    time = np.array(time_column(table))
    columns: dict[str, tuple[str, ...]] = {}
    for index, header in enumerate(table.names):
        cells = tuple(cell or "" for cell in table.columns.column(index).to_pylist())
        name = header if header in arrays else plain_name(header)
        if name.lower() == "time":
            continue
        shape = arrays.get(name, ())
        split = _split(path, name, cells, shape)
        columns |= dict(zip(element_names(name, shape), split, strict=True))
    return ReferenceTable(path, time, columns)


def _split(
    path: Path, name: str, cells: Sequence[str], shape: tuple[int, ...]
) -> list[tuple[str, ...]]:
    if not shape:
        return [tuple(cells)]
    size = int(np.prod(shape))
    rows = [cell.split() for cell in cells]
    wrong = next((row for row in rows if len(row) != size), None)
    if wrong is not None:
        raise UsageError(
            f"{path}: column {name!r} has a cell of {len(wrong)} elements, the array has {size}"
        )
    return [tuple(column) for column in zip(*rows, strict=True)]
