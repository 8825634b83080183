"""A run under a supervisor, from a system to a result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.clock import to_nanoseconds
from harness.errors import HarnessError, SimulationError
from harness.master.prepared import Echo
from harness.master.run import Progress
from harness.process.checkpoint import CHECKPOINT_FILE
from harness.process.interrupts import INTERRUPTED
from harness.process.limits import Limits
from harness.process.messages import Job, Planned
from harness.process.resume import resumable
from harness.process.supervisor import Supervised, supervise
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
) -> Result:
    """Run `system` in a worker process; otherwise as `Bench.run`.

    With `resume` the `folder` holds a run of the same system that ended early; it goes on from its
    last checkpoint, or from its start where there is none yet. Raises `RecordingError` or
    `ExperimentError` where it cannot, and leaves the folder as it was.
    """
    limits = limits or Limits()
    every = limits.checkpoint if folder is not None else None
    apart = limits.checkpoint_simulated if folder is not None else None
    every_ns = None if apart is None else to_nanoseconds(apart, "limit checkpoint_simulated")
    resumed = resumable(folder) if resume and folder is not None else None
    job = Job(system, tuple(record), tuple(needed), echo is not None, every, every_ns, resumed)

    def open_recording(planned: Planned) -> Recording:
        manifest = Manifest(
            fmus=planned.fmus, seeds={"seed": system.seed}, experiment=dict(experiment or {}),
            not_resumable=planned.not_resumable, notes=planned.notes,
        )  # fmt: skip
        rows = None if not resume else resumed.rows if resumed is not None else 0
        return Recording(planned.columns, folder, manifest, continued=rows)

    return conclude(supervise(job, limits, open_recording, progress=progress, echo=echo), folder)


def conclude(found: Supervised, folder: Path | None) -> Result:
    """Close the recording and give the result, or raise what ended the run with its rows."""
    fault = found.fault
    if found.recording is None:
        assert fault is not None
        raise fault
    if fault is None:
        notes = found.outcome.notes if found.outcome is not None else ()
        result = found.recording.finish(notes=notes)
        if folder is not None:
            (folder / CHECKPOINT_FILE).unlink(missing_ok=True)
        return result
    resumable = folder is not None and (folder / CHECKPOINT_FILE).exists()
    if not isinstance(fault, Exception):
        status = found.recording.leave(_reason(fault), keep_stream=resumable)
        if isinstance(fault, KeyboardInterrupt):
            fault = KeyboardInterrupt(f"{INTERRUPTED} at t = {status.until or 0.0:.9g} s")
        raise fault
    try:
        notes = found.outcome.notes if found.outcome is not None else ()
        result = found.recording.finish(_reason(fault), keep_stream=resumable, notes=notes)
    except HarnessError as second:  # a full disk; the rows that were written stay in their stream
        if isinstance(fault, HarnessError):
            raise fault from second
        raise
    if found.died and folder is not None:
        fault = SimulationError(f"{fault}; {_kept(result, folder)}")
    if isinstance(fault, HarnessError):
        fault.result = result
    raise fault


def _kept(result: Result, folder: Path) -> str:
    until = result.status.until
    if until is None:
        return f"there are no rows, and {folder} says why"
    return f"rows until t = {until:.9g} s are in {folder}"


def _reason(fault: BaseException) -> str:
    if isinstance(fault, KeyboardInterrupt):
        return str(fault) or INTERRUPTED
    if isinstance(fault, HarnessError):
        return str(fault)
    return f"{type(fault).__name__}: {fault}"
