"""What the supervisor of a run does with what the worker of the run tells.

The rows are in shared memory as soon as the loop has written them; here they go to the recording,
so they outlive the worker whatever happens to it.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence

from harness.errors import HarnessError
from harness.master.prepared import Echo
from harness.master.run import Progress, in_time_order
from harness.process.checkpoint import write_checkpoint
from harness.process.marker import Marker, RowMemory
from harness.results.manifest import Manifest
from harness.results.recording import Recording

_REST = 10.0  # times what the rows of a look took


class RunRecorder:
    """Records the rows in the memory of `descriptor`, which `marker` counts. The worker tells the
    methods up to `take_messages` to be called, `begin` before any other."""

    def __init__(
        self,
        open_recording: Callable[[Manifest], Recording],
        marker: Marker,
        descriptor: int,
        progress: Progress | None,
        echo: Echo | None,
    ) -> None:
        self.recording: Recording | None = None
        self._open, self._progress, self._echo = open_recording, progress, echo
        self._marker, self._descriptor = marker, descriptor
        self._memory: RowMemory | None = None
        self._early = False
        self._chunk, self._taken = 1, 0  # the one under way, and its rows that are recorded
        self._next = 0.0  # when rows of it may be taken again

    def begin(self, manifest: Manifest) -> None:
        """The system is whole, and nothing of it has run."""
        self.recording = self._open(manifest)

    def room(self, rows: int, columns: int, in_order: bool) -> None:
        """The row memory has its size: rows a chunk, columns. `in_order`: every row is there for
        good as soon as it is written; otherwise that is so at the end of its chunk."""
        self._memory = RowMemory(self._descriptor, rows, columns)
        texts = any(column.dtype is None for column in self._begun.columns)
        self._early = in_order and not texts

    def chunk(self, number: int, rows: int) -> None:
        """That chunk is done; it has so many rows."""
        self._record(rows)
        self._chunk, self._taken = number + 1, 0

    def texts(self, new: Sequence[str | bytes]) -> None:
        """Rows may name these strings and binaries from now on."""
        self._begun.add_texts(new)

    def notes(self, notes: Sequence[str]) -> None:
        """What participants had to derive, leave out or do otherwise; some may have been told."""
        self._begun.add_notes(notes)

    def checkpoint(self, content: bytes) -> None:
        """The state after all chunks told so far."""
        recording = self._begun
        assert recording.folder is not None
        try:
            recording.sync()
            write_checkpoint(recording.folder, content)
        except HarnessError as fault:  # a full disk; the one before it stays
            warnings.warn(str(fault), stacklevel=2)

    def take_messages(self) -> None:
        """FMUs have logged something."""
        if self._echo is not None:
            for component, message in self._marker.messages.take():
                self._echo(component, message)

    def look(self, share: float) -> None:
        """Take rows that are there, unless that would take a tenth of the time, as with thousands
        of columns; show progress. Rows with texts wait for the end of their chunk, when all of
        their texts have come."""
        self.take_messages()
        began = time.monotonic()
        if self._early and began >= self._next:
            self._record(self._marker.rows(self._chunk) - 1)  # the newest may be half written
            self._next = began + _REST * (time.monotonic() - began)
        if self._progress is not None:
            self._progress(share)

    def take_rest(self) -> None:
        """The worker has ended: take what it has left of a chunk."""
        self.take_messages()
        self._record(self._marker.rows(self._chunk))

    @property
    def _begun(self) -> Recording:
        assert self.recording is not None
        return self.recording

    def _record(self, there: int) -> None:
        """Record the rows of the chunk under way up to number `there`."""
        if self._memory is not None and there > self._taken:
            part, self._taken = slice(self._taken, there), there
            times, rows = self._memory.of(self._chunk)
            self._begun.append(*in_time_order(times[part], rows[part]))
