"""What worker and supervisor tell one another over their pipe."""

from __future__ import annotations

import pickle
import traceback
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a simulation without a loop does not wait for the compiler
    from harness.fmi.binding.logger import LogMessage
    from harness.master.run import Outcome
    from harness.process.checkpoint import Snapshot
    from harness.results.columns import Column
    from harness.results.manifest import FmuRecord
    from harness.system.graph import Endpoint, System


@dataclass(frozen=True)
class Job:
    """What a worker has to run: `logging` asks FMUs to log, `every` is the seconds of wall
    time and `every_ns` the simulated nanoseconds between checkpoints (None: none), `resumed` what
    to begin with."""

    system: System
    record: tuple[str | Endpoint, ...] = ("*",)
    needed: tuple[str, ...] = ()
    logging: bool = False
    every: float | None = None
    every_ns: int | None = None
    resumed: Snapshot | None = None


@dataclass(frozen=True)
class Planned:
    """The system is whole; the worker waits for leave to go on. `files` by FMU component;
    `not_resumable`: why there can be no checkpoints, or nothing; `notes` are those of the plan."""

    columns: tuple[Column, ...]
    fmus: tuple[FmuRecord, ...]
    files: dict[str, Path]
    not_resumable: str
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Room:
    """The row memory has its size: rows a chunk, columns."""

    rows: int
    columns: int


@dataclass(frozen=True)
class Linked:
    """What each operation of the program is: `calls[index[i]]` is component and call of
    operation i (int32 as bytes)."""

    calls: tuple[tuple[str, str], ...]
    index: bytes
    cycles: int


@dataclass(frozen=True)
class Chunk:
    """That chunk is done; it has so many rows."""

    number: int
    rows: int


@dataclass(frozen=True)
class Texts:
    """Strings and binaries that rows may name from now on."""

    new: tuple[str | bytes, ...]


@dataclass(frozen=True)
class Checkpoint:
    """The state after all chunks told so far."""

    content: bytes


@dataclass(frozen=True)
class Heard:
    """A message of an FMU."""

    component: str
    message: LogMessage


@dataclass(frozen=True)
class Printed:
    """Text that Python wrote to `stream`, "stdout" or "stderr"."""

    stream: str
    text: str


@dataclass(frozen=True)
class Ended:
    """The run is over; `outcome` None where it was stopped, `fault` what went through it."""

    outcome: Outcome | None = None
    fault: bytes = b""


def packed(fault: BaseException) -> bytes:
    """An exception with its causes; one that cannot travel becomes a RuntimeError in its words."""
    chain: list[BaseException] = []
    current: BaseException | None = fault
    while current is not None and len(chain) < 8:
        chain.append(_portable(current))
        current = current.__cause__
    return pickle.dumps(chain)


def unpacked(content: bytes) -> BaseException:
    """The exception in `packed`, with its causes."""
    chain: list[BaseException] = pickle.loads(content)
    for fault, cause in pairwise(chain):
        fault.__cause__ = cause
    return chain[0]


def _portable(fault: BaseException) -> BaseException:
    if fault.__traceback__ is not None and len(traceback.extract_tb(fault.__traceback__)) > 1:
        where = "".join(traceback.format_tb(fault.__traceback__)[-4:])
        fault.add_note(f"in the worker process:\n{where}")
    try:
        copy = pickle.loads(pickle.dumps(fault))
    except Exception:
        return RuntimeError(f"{type(fault).__name__}: {fault}")
    return copy if isinstance(copy, BaseException) else RuntimeError(str(fault))
