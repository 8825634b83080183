"""The files of a run folder: from the stream to Parquet and CSV, and back to a `Result`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from os import cpu_count
from pathlib import Path
from typing import Any

from harness.errors import RecordingError
from harness.results.atomic import atomic_write, writing
from harness.results.columns import TIME, Column, Values, schema_of, values_in
from harness.results.csv_files import csv_texts, rows_a_block, write_csv_header
from harness.results.manifest import INCOMPLETE, RUNNING, Manifest, RunStatus, read_manifest
from harness.results.result import Result

STREAM_FILE = "rows.arrows"
PARQUET_FILE = "results.parquet"
CSV_FILE = "results.csv"
_READ_AT_ONCE = 2**26


def seal(
    folder: Path,
    manifest: Manifest | None = None,
    *,
    reason: str = "",
    keep_stream: bool = False,
) -> Result:
    """Turns the stream of an ended run into Parquet and CSV, writes the manifest, removes the
    stream, and gives the result.

    For a run whose process died, call it with the `reason` alone: the manifest in the folder is
    completed with status "incomplete" and the time of the last whole chunk. A folder that is
    sealed already is only read. With `keep_stream` the stream stays, from which a run that ended
    early can go on.
    """
    folder = Path(folder)
    stream = folder / STREAM_FILE
    if not stream.exists():
        return read_recording(folder)
    written = manifest or read_manifest(folder)
    way_out = f"; its rows are in {STREAM_FILE}"
    with writing(f"cannot write the results into {folder}", way_out=way_out):
        with atomic_write(folder / PARQUET_FILE) as table, atomic_write(folder / CSV_FILE) as text:
            last = _convert(stream, written.columns, table, text)
        if written.status.state == RUNNING:
            status = RunStatus(INCOMPLETE, last, reason or "the run ended without a word")
            written = replace(written, status=status)
        written.write(folder)
        if not keep_stream:
            stream.unlink()
    return read_recording(folder)


def read_recording(folder: Path) -> Result:
    """The result of a complete or incomplete run; raises `RecordingError` where there is none.

    Up to 64 MB of rows are read at once, and outlive the folder; of longer runs a column is read
    when it is asked for.
    """
    folder = Path(folder)
    manifest, stream = read_manifest(folder), folder / STREAM_FILE
    # the stream of a running or dead process has what it has written so far
    stored = StoredColumns(stream if stream.exists() else folder / PARQUET_FILE, manifest.columns)
    time = stored[TIME]
    if manifest.status.state == RUNNING:
        until = float(time[-1]) if len(time) else None
        status = RunStatus(INCOMPLETE, until, "the run has not ended, or its process died")
        manifest = replace(manifest, status=status)
    few = 8 * len(time) * len(stored) <= _READ_AT_ONCE
    return Result(manifest.columns, stored.read() if few else stored, manifest, folder)


@dataclass(frozen=True)
class StoredColumns(Mapping[str, Values]):
    """The columns of a run's file, its stream or Parquet, by name, "time" among them; each is read
    when it is asked for, and the last two are kept. Raises `RecordingError` where the file cannot
    be read."""

    path: Path
    columns: tuple[Column, ...]

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return iter((TIME, *(column.name for column in self.columns)))

    def __len__(self) -> int:
        """How many columns there are."""
        return 1 + len(self.columns)

    def __getitem__(self, name: str) -> Values:
        """The values of one column."""
        column = None if name == TIME else self._named[name]
        with _reading(self.path):
            return _stored(self.path, self.path.stat().st_mtime_ns, column)

    @cached_property
    def _named(self) -> dict[str, Column]:
        return {column.name: column for column in self.columns}

    def read(self) -> dict[str, Values]:
        """All of them."""
        with _reading(self.path):
            table = _table(self.path, schema_of(self.columns))
            return {name: values_in(table.column(name)) for name in self}


@lru_cache(maxsize=2)
def _stored(path: Path, _changed: int, column: Column | None) -> Values:
    """One column, None for the time; `_changed` is when the file was."""
    schema = schema_of(() if column is None else (column,))
    schema = schema if column is None else schema.remove(0)
    return values_in(_table(path, schema).column(0))


def _table(path: Path, schema: Any) -> Any:
    """The columns of a run's file that are in an Arrow schema, as a table."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    if path.name == PARQUET_FILE:
        with parquet.ParquetFile(path) as file:
            return file.read(schema.names)
    batches = [batch.select(schema.names) for batch in _whole_batches(path)]
    return pa.Table.from_batches(batches, schema)


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    import pyarrow as pa

    try:
        yield
    except (OSError, pa.ArrowInvalid) as fault:
        raise RecordingError(f"cannot read the results in {path.parent}: {fault}") from fault


def _whole_batches(stream: Path) -> Iterator[Any]:
    """The record batches of a stream up to its end or to the first that is not whole."""
    import pyarrow as pa

    with pa.OSFile(str(stream), "rb") as source:
        try:
            reader = pa.ipc.open_stream(source)
        except pa.ArrowInvalid:  # the process died before the schema was written
            return
        while True:
            try:
                batch = reader.read_next_batch()
            except (StopIteration, pa.ArrowInvalid, OSError):
                return
            yield batch


def first_rows(folder: Path, count: int) -> Iterator[Any]:
    """The first `count` rows of a run folder's stream as record batches; raises `RecordingError`
    where it does not hold as many."""
    missing = count
    stream = folder / STREAM_FILE
    for batch in _whole_batches(stream) if stream.exists() else ():
        if missing > 0:
            yield batch.slice(0, min(missing, batch.num_rows))
            missing -= batch.num_rows
    if missing > 0:
        raise RecordingError(f"{stream} lacks {missing} of the {count} rows before the checkpoint")


def _blocks(stream: Path, size: int) -> Iterator[Any]:
    """The stream's rows as tables of `size` rows; the last may be shorter."""
    import pyarrow as pa

    held: list[Any] = []
    rows = 0
    for batch in _whole_batches(stream):
        held.append(batch)
        rows += batch.num_rows
        if rows >= size:
            table = pa.Table.from_batches(held).combine_chunks()
            for start in range(0, rows - size + 1, size):
                yield table.slice(start, size)
            held, rows = table.slice(rows - rows % size).to_batches(), rows % size
    if held:
        yield pa.Table.from_batches(held).combine_chunks()


def _convert(stream: Path, columns: Sequence[Column], table: Path, text: Path) -> float | None:
    """Writes the rows of the stream as Parquet and CSV; the last time (s), None without rows."""
    import pyarrow.parquet as parquet

    last: float | None = None
    with (
        parquet.ParquetWriter(table, schema_of(columns)) as table_file,
        text.open("wb") as file,
        ThreadPoolExecutor(cpu_count()) as pool,
    ):
        write_csv_header(file, columns)
        for block in _blocks(stream, rows_a_block(1 + len(columns))):
            last = block.column(TIME)[-1].as_py()
            texts = csv_texts(pool, block)
            table_file.write_table(block)  # while the threads make the texts
            file.writelines(texts)
    return last
