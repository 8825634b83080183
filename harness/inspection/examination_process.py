"""The workers of an examination: what they do, and what is made of their ends.

The checks of a kind of interface run one after the other in one worker. Where it dies, hangs or
takes too much memory, the check that ran then has failed, and a new worker goes on with the rest.
A worker runs a program of its own (`examiner`): in the copies of one process, addresses and memory
that was never set would look alike. This module loads no library of the FMU itself, so whatever
the FMU does, the caller lives.
"""

from __future__ import annotations

import math
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path

from harness.errors import HarnessError, SimulationError
from harness.fmi.binding.interface import MODEL_EXCHANGE
from harness.fmi.fmu import Fmu
from harness.inspection.catalogue import CHECKS, CONTINUES_ELSEWHERE, ELSEWHERE, REPEATS_ELSEWHERE
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

Progress = Callable[[float, str], None]
"""Called with the share that is done of an interface, and the name of the check that begins."""


@dataclass
class Round:
    """What a worker tells: the checks that it has `found` out, and that which is `running`.

    The deadline is that of the FMU, no code of which runs before the first check begins.
    """

    deadline: float
    progress: Callable[[str], None]
    found: list[Finding] = field(default_factory=list)
    running: str = ""
    since: float = math.inf

    def begins(self, check: str) -> None:
        """A check begins."""
        self.running, self.since = check, time.monotonic()
        self.progress(check)

    def ends(self, finding: Finding) -> None:
        """The running check has ended."""
        self.running, self.since = "", time.monotonic()
        self.found.append(finding)

    def look(self, share: float) -> None:
        """Raises `SimulationError` beyond the deadline."""
        if time.monotonic() - self.since > self.deadline:
            raise SimulationError(f"no end within {self.deadline:g} s")


def examine(
    path: Path, scratch: Path, kind: str, names: Sequence[str], tell: Callable[..., None]
) -> None:
    """Run the checks called `names`, in order, and have methods of a `Round` called; who asks for
    them has judged the description."""
    load_kernels(exchange=kind == MODEL_EXCHANGE)
    with Fmu(path, validate=False) as fmu:
        subject = Subject(fmu, interface(kind, fmu.description), scratch)
        for name in names:
            tell(Round.begins, name)
            try:
                finding = (CHECKS[kind] | ELSEWHERE)[name](subject)
            except VerdictError as end:
                finding = end.finding
            except HarnessError as fault:
                finding = failed(str(fault))
            tell(Round.ends, replace(finding, check=name, interface_type=kind))


@dataclass(frozen=True)
class Examination:
    """The examination of one kind of interface; `scratch` is shared by its workers."""

    path: Path
    interface_type: str
    scratch: Path
    deadline: float
    progress: Progress | None

    def findings(self, names: list[str]) -> Iterator[Finding]:
        """Those of the checks called `names`, by as many workers as it takes."""
        left = list(names)
        while left:
            found = self._one_worker(left)
            settled = sum(finding.check in left for finding in found)
            assert settled, "each worker settles one check at least"
            left = left[settled:]
            yield from found

    def elsewhere(self, before: list[Finding]) -> Iterator[Finding]:
        """What a fresh process makes of what the first one has left."""
        digest = next((f.data["digest"] for f in before if "digest" in f.data), None)
        names = [REPEATS_ELSEWHERE] * (digest is not None)
        names += [CONTINUES_ELSEWHERE] * left_behind(self.scratch, self.interface_type).exists()
        for finding in self.findings(names):
            compare = finding.check == REPEATS_ELSEWHERE
            yield _compared(digest, finding) if compare else finding

    def _one_worker(self, names: list[str]) -> list[Finding]:
        """Findings until the worker has ended, by itself or not."""
        told, words = Round(self.deadline, self._tell), self.scratch / "words"
        if not available():
            examine(self.path, self.scratch, self.interface_type, names,
                    lambda method, given: method(told, given))  # fmt: skip
            return told.found
        limits = Limits(call=None, checkpoint=None)
        watch = Watch(limits, Marker(), told, told.look)
        task = (str(self.path), str(self.scratch), self.interface_type, *names)
        watch.follow(partial(_become_examiner, words, task))
        if not isinstance(watch.fault, SimulationError):
            raise watch.fault or AssertionError("a worker of the doctor ends without a last word")
        left = names[len(told.found) :]
        detail = str(watch.fault)
        if watch.exceeded:
            detail = f"held more than {show_memory(limits.memory_bytes or 0)} of memory"
        elif watch.died:
            detail = _death(watch.code or 0, words.read_text("utf-8", "replace"))
        if watch.died and not (watch.exceeded or watch.code or left):
            return told.found
        told.ends(replace(failed(detail), check=told.running or (left or [_END])[0],
                          interface_type=self.interface_type))  # fmt: skip
        return told.found

    def _tell(self, name: str) -> None:
        every = list(CHECKS[self.interface_type] | ELSEWHERE)
        if self.progress is not None:
            self.progress(every.index(name) / len(every), f"{self.interface_type}: {name}")


def _become_examiner(words: Path, task: Sequence[str], connection: Connection) -> None:
    """Go on as another program, whose output goes to the file `words`."""
    os.set_inheritable(connection.fileno(), True)
    with words.open("wb") as file:
        for stream in (1, 2):
            os.dup2(file.fileno(), stream)
    program = (sys.executable, "-m", "harness.inspection.examiner")
    os.execv(sys.executable, (*program, str(connection.fileno()), *task))


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
