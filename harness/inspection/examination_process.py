"""The processes of an examination: started, watched, ended.

The checks of a kind of interface run one after the other in one process. Where that process dies,
hangs or takes too much memory, the check that ran then has failed, and a new process goes on with
the rest. This module loads no library of the FMU itself, so whatever the FMU does, the caller
lives.
"""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.fmi.archive.temporary import temporary_folder
from harness.inspection.catalogue import CHECKS, CONTINUES_ELSEWHERE, ELSEWHERE, REPEATS_ELSEWHERE
from harness.inspection.finding import Finding, Verdict, failed, passed
from harness.inspection.snapshots import left_behind
from harness.process.fork import memory_of
from harness.process.limits import Limits, show_memory

_POLL = 0.02  # s
_END = "lets its process end"

Progress = Callable[[str, int, int], None]
"""Called with the name of the check that begins, its number, and how many there are."""


@dataclass(frozen=True)
class Examination:
    """The examination of one kind of interface; `scratch` is shared by its processes."""

    path: Path
    interface_type: str
    scratch: Path
    deadline: float
    progress: Progress | None

    def findings(self, names: list[str]) -> Iterator[Finding]:
        """Those of the checks called `names`, in as many processes as it takes."""
        left = list(names)
        while left:
            first = left[0]
            for finding in self.one_process(left):
                if finding.check in left:
                    left = left[left.index(finding.check) + 1 :]
                yield replace(finding, interface_type=self.interface_type)
            assert not left or left[0] != first  # each process settles one check at least

    def elsewhere(self, before: list[Finding]) -> Iterator[Finding]:
        """What a fresh process makes of what the first one has left."""
        digest = next((f.data["digest"] for f in before if "digest" in f.data), None)
        names = [REPEATS_ELSEWHERE] * (digest is not None)
        names += [CONTINUES_ELSEWHERE] * left_behind(self.scratch, self.interface_type).exists()
        for finding in self.findings(names):
            compare = finding.check == REPEATS_ELSEWHERE
            yield _compared(digest, finding) if compare else finding

    def one_process(self, names: list[str]) -> Iterator[Finding]:
        """Findings until the process has ended, by itself or not.

        The deadline is that of the FMU, no code of which runs before the first check begins.
        """
        with temporary_folder() as folder:
            out, words = folder / "findings", folder / "words"
            out.touch()
            process = self._start(out, words, names)
            running, left, since, position = "", list(names), math.inf, 0
            detail, ended = "", False
            try:
                while not (detail or ended):
                    ended = process.poll() is not None
                    lines, position = _new_lines(out, position)
                    for line in lines:
                        since = time.monotonic()
                        if "begins" in line:
                            running = line["begins"]
                            self._tell(running)
                        else:
                            running, left = "", left[1:]
                            yield Finding.from_data(line)
                    if not ended:
                        detail = self._excess(process.pid, time.monotonic() - since)
                        time.sleep(_POLL)
            finally:
                _end(process)
            if ended and (process.returncode or left):
                detail = _death(process.returncode, words.read_text("utf-8", "replace"))
            if detail:
                yield replace(failed(detail), check=running or (left or [_END])[0])

    def _excess(self, pid: int, seconds: float) -> str:
        """What the process has used too much of, as a phrase, or ""."""
        if seconds > self.deadline:
            return f"no end within {self.deadline:g} s"
        most = Limits().memory_bytes
        over = most is not None and memory_of(pid) > most
        return f"held more than {show_memory(most)} of memory" if most and over else ""

    def _tell(self, name: str) -> None:
        every = list(CHECKS[self.interface_type] | ELSEWHERE)
        if self.progress is not None:
            self.progress(f"{self.interface_type}: {name}", every.index(name), len(every))

    def _start(self, out: Path, words: Path, names: list[str]) -> subprocess.Popen[bytes]:
        """The process; what it unpacks goes away with the folder of `out`, and it has a group of
        its own with all that the FMU starts."""
        where = (str(self.path), str(out), str(self.scratch), self.interface_type)
        command = [sys.executable, "-m", "harness.inspection.examiner", *where, *names]
        host = os.environ | {"TMPDIR": str(out.parent)}
        with words.open("wb") as file:
            return subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=host,
                start_new_session=True,
            )  # fmt: skip


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process and all that it started."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


def _new_lines(out: Path, position: int) -> tuple[list[dict[str, Any]], int]:
    """Whole lines after byte `position`, and the position after them."""
    with out.open("rb") as file:
        file.seek(position)
        whole, _, _ = file.read().rpartition(b"\n")
    if not whole:
        return [], position
    return [json.loads(line) for line in whole.splitlines()], position + len(whole) + 1


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
