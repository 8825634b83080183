"""What worker and supervisor tell one another over their pipe.

Any worker sends `Told`, `Printed`, `Linked` and at its end `Done`; the supervisor sends what a
`Told` is answered by. What is told by the run of a system is its manifest as soon as the system is
whole, then any of the rest.
"""

from __future__ import annotations

import pickle
import traceback
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from harness.errors import HarnessError

if TYPE_CHECKING:  # work without a loop does not wait for the compiler
    from harness.fmi.binding.logger import LogMessage


@dataclass(frozen=True)
class Told:
    """Whatever shall outlive the worker; `answered`: it will ask for an answer."""

    content: Any
    answered: bool = False


@dataclass(frozen=True)
class Printed:
    """Text that Python wrote to `stream`, "stdout" or "stderr"."""

    stream: str
    text: str


@dataclass(frozen=True)
class Linked:
    """A loop is about to run: component and call of each of its operations, the number of its
    cycles, and the unit of its times."""

    calls: tuple[tuple[str, str], ...]
    cycles: int
    ticks_per_second: int


@dataclass(frozen=True)
class Done:
    """The work is over: `fault` is what went through it, `stopped`: it was asked to end."""

    value: Any = None
    fault: bytes = b""
    stopped: bool = False


@dataclass(frozen=True)
class Room:
    """The row memory has its size: rows a chunk, columns. `in_order`: every row is there for good
    as soon as it is written; otherwise that is so at the end of its chunk."""

    rows: int
    columns: int
    in_order: bool


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
class Notes:
    """What participants had to derive, leave out or do otherwise; some may have been told."""

    notes: tuple[str, ...]


@dataclass(frozen=True)
class Checkpoint:
    """The state after all chunks told so far."""

    content: bytes


@dataclass(frozen=True)
class Logged:
    """A message of an FMU."""

    component: str
    message: LogMessage


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
    if fault.__traceback__ is not None and not isinstance(fault, HarnessError):
        where = "".join(traceback.format_tb(fault.__traceback__)[-4:])
        fault.add_note(f"in the worker process:\n{where}")
    try:
        copy = pickle.loads(pickle.dumps(fault))
    except Exception:
        return RuntimeError(f"{type(fault).__name__}: {fault}")
    return copy if isinstance(copy, BaseException) else RuntimeError(str(fault))
