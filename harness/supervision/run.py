"""A run under a supervisor, from a system to a result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.errors import HarnessError, SimulationError
from harness.execution.prepared import Echo
from harness.execution.run import Progress
from harness.results.manifest import Manifest
from harness.results.recording import Recording
from harness.results.result import Result
from harness.supervision.limits import Limits
from harness.supervision.messages import Job, Planned
from harness.supervision.supervisor import Supervised, supervise
from harness.system.graph import System


def run_supervised(
    system: System,
    folder: Path | None = None,
    *,
    record: Sequence[str] = ("*",),
    limits: Limits | None = None,
    progress: Progress | None = None,
    echo: Echo | None = None,
    experiment: Mapping[str, Any] | None = None,
    needed: Iterable[str] = (),
) -> Result:
    """Run `system` in a worker process; otherwise as `Bench.run`."""
    limits = limits or Limits()
    every = limits.checkpoint if folder is not None else None
    job = Job(system, tuple(record), tuple(needed), echo is not None, every)

    def open_recording(planned: Planned) -> Recording:
        manifest = Manifest(
            fmus=planned.fmus, seeds={"seed": system.seed}, experiment=dict(experiment or {})
        )
        return Recording(planned.columns, folder, manifest)

    return conclude(supervise(job, limits, open_recording, progress=progress, echo=echo), folder)


def conclude(found: Supervised, folder: Path | None) -> Result:
    """Close the recording and give the result, or raise what ended the run with its rows."""
    fault = found.fault
    if found.recording is None:
        assert fault is not None
        raise fault
    if fault is None:
        return found.recording.finish()
    try:
        result = found.recording.finish(_reason(fault))
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
    if isinstance(fault, HarnessError):
        return str(fault)
    return f"{type(fault).__name__}: {fault}"
