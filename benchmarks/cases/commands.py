"""Commands timed from outside, as a user waits for them."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

from benchmarks.frame import RefusedError

HARNESS = "from harness.cli.main import main; main()"


def seconds(*arguments: str) -> float:
    """Wall time of `fmu-harness` with these arguments."""
    return timed([sys.executable, "-c", HARNESS, *arguments])


def processor() -> float:
    """Processor time (s) of this process and of all that it has waited for."""
    own, others = (
        resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime


def timed(
    command: list[str], folder: Path | None = None, variables: Mapping[str, str] | None = None
) -> float:
    """Wall time of a command (s), in `folder`, with further environment variables."""
    began = time.perf_counter()
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **(variables or {})}, check=False,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    taken = time.perf_counter() - began
    if done.returncode:
        said = done.stderr.strip().splitlines() or [f"code {done.returncode}"]
        raise RefusedError(said[-1])
    return taken
