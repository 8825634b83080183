"""A run under a supervisor, from a system to a result.

The supervisor writes the recording, so rows outlive the worker whatever happens to it: they are in
shared memory as soon as the loop has written them, and on disk a moment and a chunk's handling
later.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from os import close
from pathlib import Path
from typing import Any

from harness.errors import HarnessError, SimulationError
from harness.interrupts import INTERRUPTED
from harness.master.prepared import Echo
from harness.master.run import Progress
from harness.process.checkpoint import CHECKPOINT_FILE, resumable
from harness.process.limits import Limits
from harness.process.marker import Marker, shared_file
from harness.process.recorder import RunRecorder
from harness.process.task import live
from harness.process.warm import warm_up
from harness.process.watch import Watch
from harness.process.worker import Job, run_job
from harness.results.manifest import Manifest
from harness.results.recording import Recording
from harness.results.result import Result
from harness.system.graph import Endpoint, System


def run_supervised(
    system: System,
    folder: Path | None = None,
    *,
    record: Sequence[str | Endpoint] = ("*",),
    limits: Limits | None = None,
    progress: Progress | None = None,
    echo: Echo | None = None,
    experiment: Mapping[str, Any] | None = None,
    needed: Iterable[str] = (),
    resume: bool = False,
    overwrite: bool = False,
) -> Result:
    """Run `system` in a worker process; otherwise as `Bench.run`.

    With `resume` the `folder` holds a run of the same system that ended early; it goes on from its
    last checkpoint, or from its start where there is none yet. Raises `RecordingError` or
    `ExperimentError` where it cannot, and leaves the folder as it was.
    """
    limits = limits or Limits()
    if folder is None:  # checkpoints are for folders
        limits = replace(limits, checkpoint=None, checkpoint_simulated=None)
    resumed = resumable(folder) if resume and folder is not None else None

    first = None if not resume else resumed.rows if resumed is not None else 0

    def begin(manifest: Manifest) -> Recording:
        whole = replace(manifest, experiment=dict(experiment or {}))
        return Recording(whole.columns, folder, whole, continued=first, overwrite=overwrite)

    job = Job(system, tuple(record), tuple(needed), echo is not None, limits, resumed)
    marker, descriptor = Marker(), shared_file(0)
    recorder = RunRecorder(begin, marker, descriptor, progress, echo)
    watch = Watch(limits, marker, recorder, recorder.look, {c.name: c.path for c in system.fmus})
    warm_up(system)
    try:
        watch.follow(partial(live, partial(run_job, job, descriptor), marker))
        watch.attempt(recorder.take_rest)
    finally:
        close(descriptor)
    if watch.fault is None and progress is not None:
        progress(1.0)
    return _conclude(watch, recorder.recording, folder)


def _conclude(watch: Watch, recording: Recording | None, folder: Path | None) -> Result:
    """Close the recording and give the result, or raise what ended the run with its rows."""
    fault = watch.fault
    if recording is None:
        assert fault is not None
        raise fault
    if fault is None:
        result = recording.finish()
        if folder is not None:
            (folder / CHECKPOINT_FILE).unlink(missing_ok=True)
        return result
    resumable = folder is not None and (folder / CHECKPOINT_FILE).exists()
    if not isinstance(fault, Exception):
        found = recording.leave(_reason(fault), keep_stream=resumable)
        if isinstance(fault, KeyboardInterrupt):
            fault = KeyboardInterrupt(f"{INTERRUPTED} at t = {recording.until:.9g} s")
        fault.result = found  # type: ignore[attr-defined]
        raise fault
    try:
        result = recording.finish(_reason(fault), keep_stream=resumable)
    except HarnessError as second:  # a full disk; the rows that were written stay in their stream
        if isinstance(fault, HarnessError):
            raise fault from second
        raise
    if watch.died and folder is not None:
        until = result.status.until
        rows = f"there are no rows, and {folder} says why"
        if until is not None:
            rows = f"rows until t = {until:.9g} s are in {folder}"
        fault = SimulationError(f"{fault}; {rows}")
    if isinstance(fault, HarnessError):
        fault.result = result
    raise fault


def _reason(fault: BaseException) -> str:
    if isinstance(fault, KeyboardInterrupt):
        return str(fault) or INTERRUPTED
    return str(fault) if isinstance(fault, HarnessError) else f"{type(fault).__name__}: {fault}"
