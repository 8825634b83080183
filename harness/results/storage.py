"""The files of a run folder: from the stream to Parquet and CSV, and back to a `Result`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.errors import RecordingError
from harness.results.atomic import atomic_write, writing
from harness.results.columns import TIME, Column, numbers_of, schema_of
from harness.results.csv_files import write_csv_header, write_csv_rows
from harness.results.manifest import INCOMPLETE, RUNNING, Manifest, RunStatus, read_manifest
from harness.results.result import Result

STREAM_FILE = "rows.arrows"
PARQUET_FILE = "results.parquet"
CSV_FILE = "results.csv"
ROWS_A_BLOCK = 65_536


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
    """The result of a complete or incomplete run; raises `RecordingError` where there is none."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    folder = Path(folder)
    manifest, stream = read_manifest(folder), folder / STREAM_FILE
    try:
        if stream.exists():  # a running or dead process has written so far
            batches = list(_whole_batches(stream))
            table = pa.Table.from_batches(batches, schema=schema_of(manifest.columns))
        else:
            table = parquet.ParquetFile(folder / PARQUET_FILE).read()
    except (OSError, pa.ArrowInvalid) as fault:
        raise RecordingError(f"cannot read the results in {folder}: {fault}") from fault
    if manifest.status.state == RUNNING:
        until = table.column(TIME)[-1].as_py() if table.num_rows else None
        status = RunStatus(INCOMPLETE, until, "the run has not ended, or its process died")
        manifest = replace(manifest, status=status)
    time, *columns = table.columns
    values = [
        column.to_pylist() if known.dtype is None else numbers_of(column)
        for known, column in zip(manifest.columns, columns, strict=True)
    ]
    result = Result.of(manifest.columns, numbers_of(time), values, manifest)
    return replace(result, folder=folder)


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


def _blocks(stream: Path) -> Iterator[Any]:
    """The stream's rows as tables of at least `ROWS_A_BLOCK` rows (the last may be shorter)."""
    import pyarrow as pa

    held: list[Any] = []
    rows = 0
    for batch in _whole_batches(stream):
        held.append(batch)
        rows += batch.num_rows
        if rows >= ROWS_A_BLOCK:
            yield pa.Table.from_batches(held).combine_chunks()
            held, rows = [], 0
    if held:
        yield pa.Table.from_batches(held).combine_chunks()


def _convert(stream: Path, columns: Sequence[Column], table: Path, text: Path) -> float | None:
    """Writes the rows of the stream as Parquet and CSV; the last time (s), None without rows."""
    import pyarrow.parquet as parquet

    last: float | None = None
    with parquet.ParquetWriter(table, schema_of(columns)) as table_file, text.open("wb") as file:
        write_csv_header(file, columns)
        for block in _blocks(stream):
            last = block.column(TIME)[-1].as_py()
            table_file.write_table(block)
            write_csv_rows(file, block)
    return last
