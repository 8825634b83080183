"""Writing what a run records, so that a crash at any moment loses nothing that was written.

A run folder holds while the run goes on:

    manifest.json     what the run is made of, status "running"
    rows.arrows       Arrow IPC stream, one record batch a chunk, handed to the system at once

and when it has ended, in place of the stream:

    results.parquet   `time` and the columns, with unit and description as field metadata
    results.csv       the same; each number in the fewest digits (at most 17) that read back to
                      the same bits, so that 0.01 stays 0.01; no unit row
    manifest.json     status "complete", or "incomplete" with the time reached and the reason

A run that is interrupted ends at once, so a long stream stays as it is. A reader opens either form
(`read_recording`). Columns are stored in their own types: 64-bit integers exactly, strings as text
(in double quotes in the CSV file), binaries as bytes (hexadecimal there), booleans (0 and 1 there).
Times are float64 seconds. This module refuses to know where rows come from.
"""

from __future__ import annotations

import errno
import os
import time as clock
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from harness.errors import RecordingError
from harness.results.atomic import ANOTHER_FOLDER, writing
from harness.results.blocks import Blocks
from harness.results.columns import (
    TIME,
    Column,
    Values,
    arrow_array,
    check_columns,
    schema_of,
    texts_of,
    values_of,
)
from harness.results.manifest import (
    COMPLETE,
    INCOMPLETE,
    RUNNING,
    Manifest,
    RunStatus,
    read_manifest,
)
from harness.results.manifest import FILE_NAME as MANIFEST_FILE
from harness.results.result import Result
from harness.results.storage import (
    CSV_FILE,
    PARQUET_FILE,
    STREAM_FILE,
    first_rows,
    read_recording,
    seal,
)

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_QUICK_BYTES = 2**23  # turned into Parquet and CSV in a fraction of a second

__all__ = ["Column", "Recording", "read_recording", "seal"]

_OWN_FILES = (
    STREAM_FILE, "rows.partial", PARQUET_FILE, CSV_FILE, MANIFEST_FILE, "checkpoint.npz",
)  # fmt: skip


class Recording:
    """A recording in progress: `append` chunks, then `finish`.

    `folder` None keeps the rows in memory. Otherwise it is made, with its parents; it may exist
    only if it is empty. As a context manager it is finished on leaving, as incomplete where an
    exception passes through.
    """

    def __init__(
        self,
        columns: Iterable[Column],
        folder: Path | None = None,
        manifest: Manifest | None = None,
        *,
        continued: int | None = None,
        overwrite: bool = False,
    ) -> None:
        """Opens the recording; raises `RecordingError` where the folder cannot be used.

        With `continued` the folder holds a run that ended early, and its first so many rows are
        kept; what came after them is dropped. With `overwrite` a run that it holds is removed.
        """
        self.columns = check_columns(columns)
        self.folder = None if folder is None else Path(folder)
        self.result: Result | None = None
        self._manifest = replace(
            manifest or Manifest(), columns=self.columns, status=RunStatus(RUNNING)
        )
        self._begun = clock.perf_counter()
        self._blocks = Blocks(len(self.columns))
        self._texts: list[str | bytes] = []
        self._last: float | None = None
        self._file: Any = None
        self._stream: Any = None
        self._lock = ExitStack()
        if self.folder is not None:
            with ExitStack() as stack:
                if overwrite:
                    clear_run(self.folder)
                stack.enter_context(locked(self.folder))
                self._open(self.folder, continued)
                self._lock = stack.pop_all()

    def _open(self, folder: Path, continued: int | None) -> None:
        import pyarrow as pa

        self._schema = schema_of(self.columns)
        path = folder / STREAM_FILE
        partial = path if continued is None else path.with_suffix(".partial")
        with self._writing("cannot write into the run folder"):
            if continued is None:
                check_empty(folder)
                self._manifest.write(folder)
            self._file = partial.open("wb")
            self._stream = pa.ipc.new_stream(self._file, self._schema)
            if continued is not None:
                self._copy(folder, continued, partial)
            self._file.flush()
            if continued is not None:
                partial.replace(path)
                self._manifest.write(folder)

    def _copy(self, folder: Path, count: int, partial: Path) -> None:
        """Begin with the first `count` rows of the folder's run; without them nothing is changed"""
        try:
            for batch in first_rows(folder, count):
                self._stream.write_batch(batch)
                self._last = batch.column(0)[-1].as_py()
        except RecordingError:
            self._file.close()
            partial.unlink()
            raise

    @contextmanager
    def _writing(self, what: str) -> Iterator[None]:
        """Where the system refuses, nothing more goes into the stream; what is in it stays."""
        try:
            yield
        except OSError as fault:
            self._stream = None
            if self._file is not None:
                with suppress(OSError):
                    self._file.close()
            raise RecordingError(f"{what} {self.folder}: {fault}") from fault

    @property
    def until(self) -> float:
        """The time of the last row (s), 0 where there is none."""
        return self._last or 0.0

    def add_texts(self, new: Sequence[str | bytes]) -> None:
        """Appends to the table of texts, into which cells of text and binary columns point."""
        self._texts += new

    def add_notes(self, notes: Iterable[str]) -> None:
        """Puts notes into the manifest, each once."""
        known = dict.fromkeys((*self._manifest.notes, *notes))
        self._manifest = replace(self._manifest, notes=tuple(known))

    def append(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """Adds rows of 8-byte cells (shape (n, number of columns), see `Column`) at `times` (s,
        shape (n,)).

        When it returns, the rows survive the end of this process. A time may repeat (both sides
        of an event) but never go back.
        """
        if self.result is not None:
            raise RecordingError("rows were appended to a recording that is finished")
        if rows.shape != (len(times), len(self.columns)):
            raise RecordingError(
                f"{len(times)} rows of {len(self.columns)} columns were expected, got an array "
                f"of shape {rows.shape}"
            )
        if len(times) == 0:
            return
        self._check_order(times)
        if self.folder is None:
            self._blocks.append(times, rows)
        else:
            if self._stream is None:
                raise RecordingError(f"cannot write rows into {self.folder}, as before")
            self._write(times, rows)
        self._last = float(times[-1])

    def _check_order(self, times: NDArray[np.float64]) -> None:
        last = -np.inf if self._last is None else self._last
        if times[0] >= last and (times[1:] >= times[:-1]).all():  # NaN is neither
            return
        every = np.append(last, times)
        late = np.flatnonzero(~(every[1:] >= every[:-1]))
        before, time = every[late[0] : late[0] + 2]
        raise RecordingError(
            f"rows were recorded back in time: {time:.17g} s after {before:.17g} s"
        )

    def _write(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        import pyarrow as pa

        arrays = map(arrow_array, [times, *self._values(rows)], self._schema.types)
        with self._writing("cannot write rows into"):
            self._stream.write_batch(pa.record_batch(list(arrays), schema=self._schema))
            self._file.flush()

    def _values(self, rows: NDArray[np.float64]) -> list[Any]:
        cells = np.ascontiguousarray(rows.T)
        return [values_of(c, one, self._texts) for c, one in zip(self.columns, cells, strict=True)]

    def sync(self) -> None:
        """When it returns, the rows appended so far survive also the end of the machine."""
        if self._stream is not None:
            with self._writing("cannot write rows into"):
                os.fsync(self._file.fileno())

    def finish(self, reason: str = "", *, keep_stream: bool = False) -> Result:
        """Ends the recording and gives the result; with a `reason` the run is incomplete, and the
        stream may be kept beside the results, to be `continued`.

        A second call gives the same result.
        """
        if self.result is None:
            self.result = self._end(reason, keep_stream)
            assert self.result is not None
        return self.result

    def leave(self, reason: str, *, keep_stream: bool = False) -> Result | None:
        """Ends the recording as incomplete within a moment, for somebody who waits.

        In a folder more than `_QUICK_BYTES` of rows stay in their stream, which a reader opens and
        `seal` turns into the usual files; then there is no result. Nothing can be appended
        afterwards.
        """
        return self._end(reason, keep_stream, most=_QUICK_BYTES)

    def _end(self, reason: str, keep_stream: bool, *, most: int | None = None) -> Result | None:
        """Close; the result, None where the stream has more than `most` bytes and stays."""
        status = RunStatus(INCOMPLETE if reason else COMPLETE, self._last, reason)
        wall_time = clock.perf_counter() - self._begun
        self._manifest = replace(self._manifest, status=status, wall_time=wall_time)
        if self.folder is None:
            time, rows = self._blocks.all()
            values: dict[str, Values] = {TIME: time}
            for column, own in zip(self.columns, self._values(rows), strict=True):
                values[column.name] = texts_of(own) if isinstance(own, list) else own
            return Result(self.columns, values, self._manifest)
        with self._lock:
            stream, self._stream = self._stream, None
            with self._writing("cannot close the rows in"):
                if stream is not None:
                    stream.close()
                    self._file.close()
                if most is not None and (self.folder / STREAM_FILE).stat().st_size > most:
                    self._manifest.write(self.folder)
                    return None
            return seal(self.folder, self._manifest, keep_stream=keep_stream)

    def __enter__(self) -> Self:
        """This recording."""
        return self

    def __exit__(self, kind: object, fault: BaseException | None, trace: object) -> None:
        """Finishes it; at once where Ctrl-C or the end of the process passes through."""
        reason = "" if fault is None else f"{type(fault).__name__}: {fault}"
        if fault is None or isinstance(fault, Exception):
            self.finish(reason)
        elif self.result is None:
            self.leave(reason)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """While open, no other run writes into `folder`, which is made where it is not there.

    The system holds the lock, so it is gone with the process. Where there are no such locks,
    only the check that the folder is empty keeps runs apart. Raises `RecordingError` where the
    folder cannot be made, or another run has it.
    """
    held: int | None = None
    with writing(f"cannot make the run folder {folder}", folder, way_out=ANOTHER_FOLDER):
        if fcntl is not None:
            held = _lock(folder)
    try:
        yield
    finally:
        if held is not None and fcntl is not None:
            fcntl.flock(held, fcntl.LOCK_UN)  # also for processes forked meanwhile
            os.close(held)


def _lock(folder: Path) -> int | None:
    """A descriptor of the folder that holds its lock, None where there are no such locks."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as fault:
        os.close(descriptor)
        if fault.errno in (errno.ENOTSUP, errno.ENOSYS, errno.ENOLCK):
            return None
        if not isinstance(fault, BlockingIOError):
            raise
        raise RecordingError(
            f"another run is writing into the run folder {folder}; choose another one, or wait"
        ) from fault
    return descriptor


def clear_run(folder: Path) -> None:
    """Remove what a run has written into `folder`, and nothing else; a folder that holds none stays
    as it is. Raises `RecordingError` where that cannot be, or the run is being written."""
    try:
        read_manifest(folder)
    except RecordingError:
        return
    with writing(f"cannot clear the run folder {folder}", way_out=ANOTHER_FOLDER), locked(folder):
        for name in _OWN_FILES:
            (folder / name).unlink(missing_ok=True)


def check_empty(folder: Path) -> None:
    """Raises `RecordingError` where the run folder holds something."""
    held = next(folder.iterdir(), None)
    if held is not None:
        raise RecordingError(
            f"the run folder {folder} is not empty (it holds {held.name!r}); nothing was changed "
            "in it: choose another folder, remove it first, or replace the run that it holds by "
            "overwrite (on the command line --overwrite)"
        )
