"""CSV files of results: strict writing, liberal reading.

Written: comma, the first column "time", names in double quotes exactly as recorded, booleans and
clocks 0 and 1, enumerations as numbers, integers in full, floating numbers in the fewest digits
(at most 17) that read back to the same bits, strings in double quotes, binaries as hexadecimal
digits in double quotes; no unit row.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

from harness.errors import RecordingError
from harness.results.columns import TIME, Column
from harness.results.result import Result
from harness.results.whole import whole


def write_csv(result: Result, path: Path) -> None:
    """Write `result` as CSV, whole or not at all; raises `RecordingError`."""
    import pyarrow as pa

    texts = result.texts
    arrays = [
        pa.array(texts[name], pa.string()) if name in texts else pa.array(result[name])
        for name in (TIME, *result.names)
    ]
    table = pa.Table.from_arrays(arrays, names=[TIME, *result.names])
    try:
        with whole(path) as partial, partial.open("wb") as file:
            write_csv_header(file, result.columns)
            write_csv_rows(file, table)
    except OSError as fault:
        raise RecordingError(f"{path} cannot be written: {fault.strerror or fault}") from fault


def write_csv_header(file: IO[bytes], columns: Sequence[Column]) -> None:
    """The first line: names in double quotes, verbatim but for doubled quotes."""
    names = (name.replace('"', '""') for name in (TIME, *(column.name for column in columns)))
    file.write((",".join(f'"{name}"' for name in names) + "\n").encode())


def write_csv_rows(file: IO[bytes], table: Any) -> None:
    """The rows of an Arrow table, its first column the time."""
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    def shown(column: Any) -> Any:
        if pa.types.is_boolean(column.type):
            return column.cast(pa.int8())
        if pa.types.is_binary(column.type):
            return pa.array([one.hex() for one in column.to_pylist()], pa.string())
        return column

    plain = pa.table(list(map(shown, table.columns)), names=table.column_names)
    arrow_csv.write_csv(plain, file, arrow_csv.WriteOptions(include_header=False))
