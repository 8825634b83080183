"""Examines the behaviour of an FMU in disposable processes, and draws the conclusions.

The checks run one after the other in one process. Where that process dies or hangs, the check
that ran then has failed, and a new process goes on with the rest. This module loads no library
of the FMU itself, so whatever the FMU does, the caller lives.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.fmi.fmu import Fmu
from harness.fmi.temporary import make_folder
from harness.inspection.checks import CHECKS, CYCLES
from harness.inspection.finding import Finding, Verdict, failed, passed
from harness.supervision.limits import Limits, show_memory
from harness.supervision.process import memory_of

DEADLINE = 60.0
"""Seconds that one check may take."""

_POLL = 0.02  # s
_END = "lets its process end"
_REPEATS = "repeats a run"

Progress = Callable[[str, int, int], None]
"""Called with the name of the check that begins, its number, and how many there are."""


@dataclass(frozen=True)
class Allowance:
    """Whether one way of using the FMU here is safe, and why not where it is not."""

    use: str
    allowed: bool
    reason: str


@dataclass(frozen=True)
class Diagnosis:
    """All findings about an FMU; `allowances` are what they mean for its use."""

    path: Path
    sha256: str
    findings: tuple[Finding, ...]

    @property
    def lies(self) -> tuple[str, ...]:
        """Statements of the model description that the behaviour contradicts."""
        return tuple(dict.fromkeys(lie for f in self.findings for lie in f.lies))

    @property
    def healthy(self) -> bool:
        """Whether no check failed."""
        return all(f.verdict is not Verdict.FAILED for f in self.findings)

    @property
    def allowances(self) -> tuple[Allowance, ...]:
        """The uses that need more than a step, and whether the findings allow them."""
        by_check = {f.check: f for f in self.findings}
        return tuple(
            _allowance(use, [by_check[need] for need in needs if need in by_check])
            for use, needs in _NEEDS.items()
        )

    def as_data(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "fmu": str(self.path),
            "sha256": self.sha256,
            "healthy": self.healthy,
            "findings": [f.as_data() for f in self.findings],
            "lies": list(self.lies),
            "allowed": {a.use: a.allowed for a in self.allowances},
        }


_NEEDS = {
    "jacobi and gauss-seidel": ("runs",),
    "iterative, snapshots": ("runs", "restores a snapshot"),
    "delays within a step": ("runs", "takes other steps"),
    "several instances in one run": ("runs", "instantiates twice"),
    "reset between runs": ("runs", "resets"),
    "exact sensitivity": ("runs", "derivatives"),
    "long studies in one process": ("runs", f"survives {CYCLES} instances"),
}


def _allowance(use: str, needed: list[Finding]) -> Allowance:
    for finding in needed:
        if finding.verdict is not Verdict.PASSED:
            return Allowance(use, False, f"{finding.check}: {finding.detail}")
    return Allowance(use, bool(needed), "" if needed else "not examined")


def examine(
    path: Path, *, deadline: float = DEADLINE, progress: Progress | None = None
) -> Diagnosis:
    """Examine the FMU at `path`; raises `FmuError` when it cannot even be read.

    `deadline` (s) bounds each check.
    """
    with Fmu(path) as fmu:
        sha256 = fmu.sha256
    findings = list(_findings(path, list(CHECKS), deadline, progress))
    return Diagnosis(path, sha256, (*findings, *_in_another_process(path, findings, deadline)))


def _findings(
    path: Path, names: list[str], deadline: float, progress: Progress | None
) -> Iterator[Finding]:
    left = list(names)
    while left:
        first = left[0]
        for finding in _one_process(path, left, deadline, progress):
            if finding.check in left:
                left = left[left.index(finding.check) + 1 :]
            yield finding
        assert not left or left[0] != first  # each process settles one check at least


def _one_process(
    path: Path, names: list[str], deadline: float, progress: Progress | None
) -> Iterator[Finding]:
    """Findings until the process has ended, by itself or not."""
    most = Limits().memory_bytes
    with closing(_Folder()) as folder:
        out, words = folder.path / "findings", folder.path / "words"
        out.touch()
        process = _start(path, out, words, names)
        running, left, since, position = "", list(names), time.monotonic(), 0
        try:
            while True:
                ended = process.poll() is not None
                lines, position = _new_lines(out, position)
                for line in lines:
                    since = time.monotonic()
                    if "begins" in line:
                        running = line["begins"]
                        if progress is not None:
                            progress(running, len(CHECKS) - len(left), len(CHECKS))
                    else:
                        running, left = "", left[1:]
                        yield Finding.from_data(line)
                if ended:
                    break
                if time.monotonic() - since > deadline:
                    yield replace(failed(f"no end within {deadline:g} s"), check=running or _END)
                    return
                if most is not None and memory_of(process.pid) > most:
                    told = f"held more than {show_memory(most)} of memory"
                    yield replace(failed(told), check=running or _END)
                    return
                time.sleep(_POLL)
        finally:
            _end(process)
        if process.returncode or left:
            detail = _death(process.returncode, words.read_text("utf-8", "replace"))
            yield replace(failed(detail), check=running or (left or [_END])[0])


def _start(path: Path, out: Path, words: Path, names: list[str]) -> subprocess.Popen[bytes]:
    """The process; what it unpacks goes away with the folder of `out`, and it has a group of its
    own with all that the FMU starts."""
    command = [sys.executable, "-m", "harness.inspection.examiner", str(path), str(out), *names]
    surroundings = os.environ | {"TMPDIR": str(out.parent)}
    with words.open("wb") as file:
        return subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=surroundings,
            start_new_session=True,
        )  # fmt: skip


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process and all that it started."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


class _Folder:
    """A temporary folder that also the next start removes, should this process be killed."""

    def __init__(self) -> None:
        self.path = make_folder()

    def close(self) -> None:
        shutil.rmtree(self.path, ignore_errors=True)


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


def _in_another_process(path: Path, findings: list[Finding], deadline: float) -> Iterator[Finding]:
    """Whether a run in a fresh process gives the bits of the first one."""
    first = next((f.data["digest"] for f in findings if "digest" in f.data), None)
    if first is None:
        return
    for finding in _one_process(path, [_REPEATS], deadline, None):
        if finding.check == _REPEATS:
            yield replace(_compared(first, finding), check="repeats in a new process")


def _compared(first: str, finding: Finding) -> Finding:
    if finding.data.get("digest") == first:
        return passed("bit for bit")
    if finding.verdict is Verdict.FAILED:
        return failed(finding.detail)
    return failed("the values depend on the process, as uninitialised memory does")
