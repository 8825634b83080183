"""`simulate` in a process of its own: whatever the FMU does, the caller lives and has the rows.

The rows come over a pipe after every step. An FMU that crashes, or ends its process, leaves
one sentence and the rows that came before. What is passed must be picklable, so functions as inputs
are not; a hanging FMU is ended by an interrupt (Ctrl-C).
"""

from __future__ import annotations

import multiprocessing
import signal
import tempfile
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from harness.errors import HarnessError, SimulationError
from harness.fmi.logger import LogMessage
from harness.fmi.temporary import sweep
from harness.results.manifest import INCOMPLETE, Manifest, RunStatus
from harness.simulation.outputs import Rows, SimulationResult
from harness.simulation.simulate import Progress, simulate

_PATIENCE = 2.0  # s, for a process that was told to end


def simulate_isolated(
    fmu: Path,
    options: dict[str, Any],
    *,
    progress: Progress | None = None,
    echo: Callable[[LogMessage], None] | None = None,
) -> SimulationResult:
    """As `simulate(fmu, **options)`; raises the same faults, and `SimulationError` where the FMU
    brought its process down."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(
        target=_work, args=(sender, fmu, options, echo is not None), daemon=True
    )
    process.start()
    sender.close()
    parent = _Parent(progress, echo)
    try:
        while parent.hear(receiver):
            pass
    except KeyboardInterrupt:
        parent.fault = SimulationError(f"interrupted{parent.after()}")
    finally:
        process.join(_PATIENCE if parent.ended else 0.1)
        if process.is_alive():
            process.kill()
            process.join()
        sweep(Path(tempfile.gettempdir()))
    return parent.conclude(process.exitcode)


class _Parent:
    """What came over the pipe."""

    def __init__(
        self, progress: Progress | None, echo: Callable[[LogMessage], None] | None
    ) -> None:
        self.progress, self.echo = progress, echo
        self.rows: Rows | None = None
        self.fault: HarnessError | None = None
        self.manifest = Manifest()
        self.notes: tuple[str, ...] = ()
        self.ended = False

    def hear(self, receiver: Connection) -> bool:
        """Take one message; False after the last one."""
        try:
            kind, content = receiver.recv()
        except (EOFError, OSError):
            return False
        if kind == "rows":
            self.rows = content
        elif kind == "more" and self.rows is not None:
            self.rows.extend(content)
        elif kind == "share" and self.progress is not None:
            self.progress(content)
        elif kind == "log" and self.echo is not None:
            self.echo(content)
        elif kind == "end":
            self.fault, self.manifest, self.notes = content
            self.ended = True
        return True

    def after(self) -> str:
        """Where the rows end, as a phrase."""
        times = [] if self.rows is None else self.rows.times
        return f" after t = {times[-1]:.9g} s" if times else " before its first row"

    def conclude(self, exit_code: int | None) -> SimulationResult:
        """The result, or the fault with what there is of it."""
        if not self.ended and self.fault is None:
            self.fault = SimulationError(
                f"the FMU brought its process down{self.after()}: {_how(exit_code)}"
            )
        if self.fault is not None:
            if not self.ended:
                status = RunStatus(INCOMPLETE, None, str(self.fault))
                self.manifest = Manifest(status=status)
            self.fault.result = self.rows and self.rows.result(self.manifest, self.notes)
            raise self.fault
        assert self.rows is not None
        return self.rows.result(self.manifest, self.notes)


def _how(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        with suppress(ValueError):
            return f"it crashed with {signal.Signals(-exit_code).name}"
    return f"it ended with exit code {exit_code}"


def _work(sender: Connection, fmu: Path, options: dict[str, Any], logging: bool) -> None:
    """What the process does."""

    def send(kind: str, content: Any) -> None:
        sender.send((kind, content))

    shares = [0.0]
    begun: list[bool] = []

    def take(rows: Rows) -> None:
        send(*(("more", rows.content) if begun else ("rows", rows)))
        begun[:] = [True]

    def share(done: float) -> None:
        if done - shares[0] >= 0.01:
            shares[0] = done
            send("share", done)

    try:
        result = simulate(
            fmu, **options, progress=share, on_rows=take,
            echo=(lambda message: send("log", message)) if logging else None,
        )  # fmt: skip
        send("end", (None, result.manifest, result.notes))
    except HarnessError as fault:
        left, fault.result = fault.result, None
        manifest = left.manifest if left is not None else Manifest()
        send("end", (fault, manifest, left.notes if left is not None else ()))
