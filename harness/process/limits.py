"""What a run may use: time for a call, time for the run, memory; and whether it uses more.

This module refuses to end anything; the supervisor does, or the watchdog.
"""

from __future__ import annotations

import os
import re
import time
from dataclasses import dataclass
from pathlib import Path

from harness.clock import to_nanoseconds
from harness.errors import UsageError
from harness.process.marker import WORKING, Where

CALL_SECONDS = 300.0
CHECKPOINT_SECONDS = 10.0

_SHARE = 0.9  # of the machine's memory, where no limit is given
_UNITS = {"": 1, "B": 1, "kB": 10**3, "MB": 10**6, "GB": 10**9, "TB": 10**12,
          "KiB": 2**10, "MiB": 2**20, "GiB": 2**30, "TiB": 2**40}  # fmt: skip
_CGROUP = Path("/sys/fs/cgroup/memory.max")


@dataclass(frozen=True)
class Limits:
    """Limits of one run: seconds a single call may take, seconds the whole run may take (None:
    any), bytes of memory the worker may hold (None: nine tenths of the machine's), and every how
    many seconds of wall time, and of simulated time, a checkpoint is written (None: never). With
    `isolate` the worker gives up what `harness.process.isolation` says."""

    call: float | None = CALL_SECONDS
    run: float | None = None
    memory: int | None = None
    checkpoint: float | None = CHECKPOINT_SECONDS
    isolate: bool = False
    checkpoint_simulated: float | None = None

    def __post_init__(self) -> None:
        """Raises `UsageError` where a limit is not positive."""
        for name in ("call", "run", "memory", "checkpoint", "checkpoint_simulated"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise UsageError(f"limit {name} must be positive, not {value!r}")
        if self.checkpoint_simulated is not None:
            to_nanoseconds(self.checkpoint_simulated, "limit checkpoint_simulated")

    @property
    def memory_bytes(self) -> int | None:
        """The limit in force; None where the machine does not say what it has."""
        return self.memory if self.memory is not None else _default_memory()


class Deadlines:
    """Of the run that begins now; a call begins, or goes on, whenever something moves."""

    def __init__(self, limits: Limits) -> None:
        """Nothing has moved yet."""
        self.limits = limits
        self._began = self._moved = time.monotonic()
        self._last: Where | None = None

    def exceeded(self, where: Where, held: int) -> str:
        """The limit that is exceeded, "call", "run" or "memory", or nothing; `where` the process
        is now, `held` the bytes that it holds."""
        now, limits = time.monotonic(), self.limits
        if where != self._last or where.place == WORKING:
            self._last, self._moved = where, now
        if limits.call is not None and now - self._moved > limits.call:
            return "call"
        if limits.run is not None and now - self._began > limits.run:
            return "run"
        most = limits.memory_bytes
        return "memory" if most is not None and held > most else ""


def memory_size(text: str | int) -> int:
    """Bytes of "4 GiB", "500 MB" or a number; raises `UsageError`."""
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*([A-Za-z]*)\s*", str(text))
    units = {name.lower(): size for name, size in _UNITS.items()}
    if match is None or match[2].lower() not in units:
        raise UsageError(
            f"memory limit {text!r} must be a number with one of the units "
            f"{', '.join(name for name in _UNITS if name)}, as in '4 GiB'"
        )
    return int(float(match[1]) * units[match[2].lower()])


def show_memory(size: int) -> str:
    """Bytes as people write them, such as "1.5 GiB"."""
    for unit in ("GiB", "MiB", "KiB"):
        if size >= _UNITS[unit]:
            return f"{size / _UNITS[unit]:.3g} {unit}"
    return f"{size} B"


def _default_memory() -> int | None:
    try:
        found = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
        found += [int(_CGROUP.read_text())] if _CGROUP.is_file() else []
    except (OSError, ValueError):  # the control group says "max", or there is none
        return None if not found else int(_SHARE * found[0])
    return int(_SHARE * min(found))
