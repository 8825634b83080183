"""The workers of an examination: what they do, and what is made of their ends.

The checks of a kind of interface run one after the other in one worker. Where it dies, hangs or
takes too much memory, the check that ran then has failed, and a new worker goes on with the rest.
What is compared with them runs in one more, for all kinds. A worker runs a program of its own
(`examiner`): in the copies of one process, addresses and memory that was never set would look
alike. This module loads no library of the FMU itself, so whatever the FMU does, the caller lives.
"""

from __future__ import annotations

import json
import math
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from multiprocessing.connection import Connection
from pathlib import Path

from harness.errors import HarnessError, SimulationError
from harness.fmi.binding.interface import MODEL_EXCHANGE, InterfaceType
from harness.fmi.fmu import Fmu
from harness.inspection.catalogue import (
    CHECKS,
    CONTINUES_ELSEWHERE,
    ELSEWHERE,
    REPEATS_ELSEWHERE,
)
from harness.inspection.finding import Finding, Verdict, VerdictError, failed, passed
from harness.inspection.snapshots import left_behind
from harness.inspection.subject import Subject
from harness.participants.kinds import load_kernels
from harness.process.fork import available
from harness.process.limits import Limits, show_memory
from harness.process.marker import Marker
from harness.process.watch import Watch
from harness.system.policy import interface

_END = "lets its process end"

Task = tuple[InterfaceType, str]
"""A kind of interface, and the name of a check."""

Progress = Callable[[float, str], None]
"""Called with the share that is done of an interface, and the name of the check that begins."""


@dataclass
class Round:
    """What a worker tells: the checks that it has `found` out, and that which is `running`.

    The deadline is that of the FMU, no code of which runs before the first check begins.
    """

    deadline: float
    progress: Callable[[Task], None]
    found: list[Finding] = field(default_factory=list)
    running: Task | None = None
    since: float = math.inf

    def begins(self, task: Task) -> None:
        """A check begins."""
        self.running, self.since = task, time.monotonic()
        self.progress(task)

    def ends(self, finding: Finding) -> None:
        """The running check has ended."""
        self.running, self.since = None, time.monotonic()
        self.found.append(finding)

    def look(self, share: float) -> None:
        """Raises `SimulationError` beyond the deadline."""
        if time.monotonic() - self.since > self.deadline:
            raise SimulationError(f"no end within {self.deadline:g} s")


def examine(path: Path, scratch: Path, tasks: Sequence[Task], tell: Callable[..., None]) -> None:
    """Run the checks in order, and have methods of a `Round` called; who asks for them has judged
    the description."""
    load_kernels(exchange=any(kind == MODEL_EXCHANGE for kind, _ in tasks))
    with Fmu(path, validate=False) as fmu:
        subject = cache(lambda kind: Subject(fmu, interface(kind, fmu.description), scratch))
        for kind, name in tasks:
            tell(Round.begins, (kind, name))
            try:
                finding = (CHECKS[kind] | ELSEWHERE)[name](subject(kind))
            except VerdictError as end:
                finding = end.finding
            except HarnessError as fault:
                finding = failed(str(fault))
            tell(Round.ends, replace(finding, check=name, interface_type=kind))


@dataclass(frozen=True)
class Examination:
    """The examination of one FMU; `scratch` is shared by its workers."""

    path: Path
    scratch: Path
    deadline: float
    progress: Progress | None

    def findings(self, kind: InterfaceType) -> list[Finding]:
        """Those of all checks of a kind of interface."""
        return list(self._settled([(kind, name) for name in CHECKS[kind]]))

    def elsewhere(self, before: Sequence[Finding]) -> Iterator[Finding]:
        """What a fresh program makes of what the workers of `findings` have left."""
        digests = {f.interface_type: f.data["digest"] for f in before if "digest" in f.data}
        tasks: list[Task] = []
        for kind in CHECKS:
            tasks += [(kind, REPEATS_ELSEWHERE)] * (kind in digests)
            tasks += [(kind, CONTINUES_ELSEWHERE)] * left_behind(self.scratch, kind).exists()
        for finding in self._settled(tasks):
            compare = finding.check == REPEATS_ELSEWHERE
            yield _compared(digests[finding.interface_type], finding) if compare else finding

    def _settled(self, tasks: list[Task]) -> Iterator[Finding]:
        """The findings of as many workers as it takes."""
        left = list(tasks)
        while left:
            found = self._one_worker(left)
            settled = sum((f.interface_type, f.check) in left for f in found)
            assert settled, "each worker settles one check at least"
            left = left[settled:]
            yield from found

    def _one_worker(self, tasks: list[Task]) -> list[Finding]:
        """Findings until the worker has ended, by itself or not."""
        told = Round(self.deadline, self._tell)
        if not available():
            examine(self.path, self.scratch, tasks, lambda method, given: method(told, given))
            return told.found
        limits = Limits(call=None, checkpoint=None)
        watch = Watch(limits, Marker(), told, told.look)
        watch.follow(partial(self._become_examiner, tasks))
        if not isinstance(watch.fault, SimulationError):
            raise watch.fault or AssertionError("a worker of the doctor ends without a last word")
        left = tasks[len(told.found) :]
        detail = str(watch.fault)
        if watch.exceeded:
            detail = f"held more than {show_memory(limits.memory_bytes or 0)} of memory"
        elif watch.died:
            detail = _death(watch.code or 0, self._words.read_text("utf-8", "replace"))
        if watch.died and not (watch.exceeded or watch.code or left):
            return told.found
        kind, check = told.running or (left or [(tasks[-1][0], _END)])[0]
        told.ends(replace(failed(detail), check=check, interface_type=kind))
        return told.found

    @property
    def _words(self) -> Path:
        """What a worker says on its standard output and error."""
        return self.scratch / "words"

    def _become_examiner(self, tasks: Sequence[Task], connection: Connection) -> None:
        """Go on as another program, whose output goes to the file of its words."""
        os.set_inheritable(connection.fileno(), True)
        with self._words.open("wb") as file:
            for stream in (1, 2):
                os.dup2(file.fileno(), stream)
        given = str(connection.fileno()), str(self.path), str(self.scratch), json.dumps(tasks)
        os.execv(sys.executable, (sys.executable, "-m", "harness.inspection.examiner", *given))

    def _tell(self, task: Task) -> None:
        kind, name = task
        every = list(CHECKS[kind] | ELSEWHERE)
        if self.progress is not None:
            self.progress(every.index(name) / len(every), f"{kind}: {name}")


def _death(code: int, words: str) -> str:
    last = words.strip().splitlines()[-1:] or [""]
    said = f" ({last[0][:200]})" if last[0] else ""
    if code == 0:
        return f"the FMU ended the process with exit code 0{said}"
    if code < 0:
        return f"the process died of {signal.Signals(-code).name}{said}"
    return f"the process ended with exit code {code}{said}"


def _compared(first: str | None, finding: Finding) -> Finding:
    """The finding about a run in a new process, whose hash should be `first`."""
    judged = finding
    if finding.data.get("digest") == first:
        judged = passed("bit for bit")
    elif finding.verdict is not Verdict.FAILED:
        judged = failed("the values depend on the process, as uninitialised memory does")
    return replace(judged, check=finding.check, interface_type=finding.interface_type)
