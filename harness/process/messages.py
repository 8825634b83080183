"""What a worker tells its supervisor over their pipe; the supervisor sends back what a `Told` that
is answered has returned. What is told by the run of a system is listed by `recorder`."""

from __future__ import annotations

import pickle
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from harness.errors import HarnessError


@dataclass(frozen=True)
class Told:
    """`method` is to be called of whoever receives what is told, with the `arguments`; `answered`:
    the worker will ask for what it returns."""

    method: Callable[..., Any]
    arguments: tuple[Any, ...]
    answered: bool


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
