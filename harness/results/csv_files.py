"""CSV files of results: strict writing, liberal reading.

Written: comma, the first column "time", names in double quotes exactly as recorded, booleans and
clocks 0 and 1, enumerations as numbers, integers in full, floating numbers in the fewest digits
(at most 17) that read back to the same bits, strings in double quotes, binaries as hexadecimal
digits in double quotes; no unit row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.fmi.description.model_description import element_names
from harness.results.atomic import atomic_write, writing
from harness.results.columns import TIME, Column, arrow_array
from harness.results.result import Result

_CELLS_A_BLOCK, _CELLS_A_PIECE = 2**21, 2**18
_LEAST_ROWS = 256  # of a piece: each column of each costs as much as some hundred numbers


def write_csv(result: Result, path: Path) -> None:
    """Write `result` as CSV, whole or not at all; raises `RecordingError`."""
    import pyarrow as pa

    names = (TIME, *result.names)
    values = (result.values[name] for name in names)
    arrays = [arrow_array(v, pa.string() if isinstance(v, tuple) else None) for v in values]
    table = pa.Table.from_arrays(arrays, names=list(names))
    cannot = writing(f"{path} cannot be written")
    with cannot, atomic_write(path) as partial, partial.open("wb") as file:
        write_csv_header(file, result.columns)
        with ThreadPoolExecutor(cpu_count()) as pool:
            for start in range(0, table.num_rows, block := rows_a_block(table.num_columns)):
                file.writelines(csv_texts(pool, table.slice(start, block)))


def rows_a_block(columns: int) -> int:
    """Rows that are converted at a time: some 16 MB of them, at least 512."""
    return max(2 * _LEAST_ROWS, _CELLS_A_BLOCK // columns)


def write_csv_header(file: IO[bytes], columns: Sequence[Column]) -> None:
    """The first line: names in double quotes, verbatim but for doubled quotes."""
    names = (name.replace('"', '""') for name in (TIME, *(column.name for column in columns)))
    file.write((",".join(f'"{name}"' for name in names) + "\n").encode())


def csv_texts(pool: Executor, table: Any) -> Iterator[Any]:
    """The rows of an Arrow table, its first column the time, as buffers of text in their order,
    made at the same time by the threads of `pool`."""
    rows = max(_LEAST_ROWS, _CELLS_A_PIECE // table.num_columns)
    return pool.map(_csv_text, [table.slice(at, rows) for at in range(0, table.num_rows, rows)])


def _csv_text(table: Any) -> Any:
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    def shown(column: Any) -> Any:
        if pa.types.is_boolean(column.type):
            return column.cast(pa.int8())
        if pa.types.is_binary(column.type):
            return pa.array([one.hex() for one in column.to_pylist()], pa.string())
        return column

    plain = pa.table(list(map(shown, table.columns)), names=table.column_names)
    sink = pa.BufferOutputStream()
    arrow_csv.write_csv(plain, sink, arrow_csv.WriteOptions(include_header=False))
    return sink.getvalue()


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
    from harness.instruments.csv_signal import plain_name, read_csv_table

    table = read_csv_table(path, as_text=True)
    columns: dict[str, tuple[str, ...]] = {}
    for index, header in enumerate(table.names):
        cells = tuple(cell or "" for cell in table.columns.column(index).to_pylist())
        name = header if header in arrays else plain_name(header)
        if name.lower() == TIME:
            continue
        shape = arrays.get(name, ())
        split = _split(path, name, cells, shape)
        columns |= dict(zip(element_names(name, shape), split, strict=True))
    return ReferenceTable(path, table.seconds, columns)


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
