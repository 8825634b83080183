"""`simulate` in a worker process: whatever the FMU does, the caller lives and has the rows.

The rows come over a pipe after every step, so those before an FMU's crash, exit or hang are kept.
How a worker is watched, limited and ended is in `harness.process`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from harness.errors import HarnessError, SimulationError
from harness.fmi.binding.logger import LogMessage
from harness.fmi.wording import shorten
from harness.process.interrupts import TerminatedError
from harness.process.limits import Limits
from harness.process.task import Teller, run_task
from harness.results.manifest import INCOMPLETE, Manifest, RunStatus
from harness.results.result import Result
from harness.simulation.outputs import Content, Rows

Progress = Callable[[float], None]
Echo = Callable[[LogMessage], None]
_SHARE = 0.01  # of the run, between two signs of progress


@dataclass
class Watched:
    """What the simulation tells while it runs: from the worker's side, or in one process."""

    teller: Teller
    logging: bool = False
    begun: bool = False
    share: float = 0.0

    def log(self, message: LogMessage) -> None:
        """The FMU has logged something."""
        self.teller.logged(shorten(message.text, 300))
        if self.logging:
            self.teller.tell(message)

    def rows(self, rows: Rows) -> None:
        """There are new rows; they are taken away."""
        if rows.times or not self.begun:
            taken = rows.take()
            self.teller.tell(taken.content if self.begun else taken)
            self.begun = True

    def reached(self, time: float, share: float) -> None:
        """The run has come to `time` (s), `share` of it is done."""
        if share - self.share >= _SHARE:
            self.share = share
            self.teller.tell(share)
        self.teller.reached(time)


@dataclass
class _Heard:
    """The caller's side."""

    progress: Progress | None
    echo: Echo | None
    rows: Rows | None = None

    def __call__(self, content: float | LogMessage | Rows | Content) -> None:
        match content:
            case float():
                if self.progress is not None:
                    self.progress(content)
            case LogMessage():
                if self.echo is not None:
                    self.echo(content)
            case Rows():
                self.rows = content
            case _:
                assert self.rows is not None
                self.rows.extend(content)

    def result(
        self,
        fault: HarnessError | TerminatedError | None,
        manifest: Manifest,
        notes: tuple[str, ...],
    ) -> Result:
        """The rows as a result, or `fault` raised with it."""
        found = None if self.rows is None else self.rows.result(manifest, notes)
        if fault is not None:
            fault.result = found
            raise fault
        assert found is not None
        return found

    @property
    def until(self) -> float | None:
        """The time of the last row (s)."""
        return self.rows.times[-1] if self.rows is not None and self.rows.times else None


Ended = tuple[HarnessError | None, Manifest, tuple[str, ...]]
"""How a simulation ended, without its rows: the fault, the manifest, the notes."""


def simulate_here(
    run: Callable[[Watched], Ended], *, progress: Progress | None, echo: Echo | None
) -> Result:
    """What `run` records, in this process; raises what it raises, with the rows as `result`."""
    heard = _Heard(progress, echo)
    return heard.result(*run(Watched(Teller(heard), echo is not None)))


def simulate_apart(
    run: Callable[[Watched], Ended],
    file: Path,
    *,
    limits: Limits,
    progress: Progress | None,
    echo: Echo | None,
) -> Result:
    """The same in a worker; raises `SimulationError` where it dies, too."""
    heard = _Heard(progress, echo)
    fault: HarnessError | TerminatedError
    try:
        ended = run_task(
            lambda teller: run(Watched(teller, echo is not None)),
            limits=limits, file=file, hear=heard,
        )  # fmt: skip
    except (HarnessError, TerminatedError) as caught:
        fault = caught
    except KeyboardInterrupt as interrupt:
        where = "before its first row" if heard.until is None else f"at t = {heard.until:.9g} s"
        fault = SimulationError(f"{interrupt or 'interrupted by Ctrl-C'} {where}")
    else:
        return heard.result(*ended)
    reason = "ended by SIGTERM" if isinstance(fault, TerminatedError) else str(fault)
    status = RunStatus(INCOMPLETE, heard.until, reason)
    return heard.result(fault, Manifest(status=status), ())
