"""Works in processes of their own, some at a time, each of which may have workers as any run has.

The processes are forked, so they have what this one has loaded. What they tell arrives at once;
what they print, and their warnings, come in the order of the works, as if one had been done after
the other. Ctrl-C and SIGTERM are passed on to all of them, once, and no other work begins.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from typing import Any

from harness.errors import SimulationError
from harness.interrupts import Interrupts
from harness.process.fork import PR_SET_PDEATHSIG, available, compiler_at_rest
from harness.process.messages import Done, Printed, packed, unpacked

Tell = Callable[..., None]
Work = Callable[[Tell], Any]
"""Is given a function that tells the other side its arguments, which can be pickled."""

_LOOK_SECONDS = 0.05


@dataclass(frozen=True)
class Ended:
    """What a work has returned, or the `fault` that went through it."""

    value: Any = None
    fault: BaseException | None = None


@dataclass(frozen=True)
class _Warned:
    message: Warning


@dataclass
class _Process:
    """One of the processes: the number of its work, and what it has said and nobody heard yet."""

    number: int
    pid: int
    connection: Connection
    unheard: list[Printed | _Warned] = field(default_factory=list)
    ended: Ended | None = None


def at_once(works: int) -> int:
    """How many of so many works are done at the same time here: one a core, on Linux."""
    return min(works, os.cpu_count() or 1) if available() else 1


def side_by_side(works: Sequence[Work], hear: Callable[..., object]) -> list[Ended]:
    """What the works have come to, in their order; `hear(number, *told)` is called with what is
    told.

    Raises `KeyboardInterrupt` or `TerminatedError` where this process was interrupted.
    """
    processes: list[_Process] = []
    with Interrupts() as interrupts:
        try:
            while living := _begin(works, processes, at_once(len(works)), interrupts):
                for connection in wait([one.connection for one in living], _LOOK_SECONDS):
                    _take(next(p for p in living if p.connection is connection), hear)
                _let_hear(processes)
        finally:
            for process in processes:
                if process.ended is None:
                    _end(process, signal.SIGKILL)
        if interrupts.reason:
            raise _interrupt(processes) or interrupts.fault()
    return [process.ended or Ended() for process in processes]


def _begin(
    works: Sequence[Work], processes: list[_Process], most: int, interrupts: Interrupts
) -> list[_Process]:
    """Begin what may begin, pass interrupts on; the processes that live."""
    living = [process for process in processes if process.ended is None]
    if number := interrupts.take():
        for process in living:
            with suppress(ProcessLookupError):
                os.kill(process.pid, number)
    while len(living) < most and len(processes) < len(works) and not interrupts.reason:
        living.append(_start(works[len(processes)], len(processes)))
        processes.append(living[-1])
    return living


def _start(work: Work, number: int) -> _Process:
    connection, other = Pipe()
    sys.stdout.flush()
    sys.stderr.flush()
    supervisor = os.getpid()
    with compiler_at_rest():
        pid = os.fork()
    if pid == 0:
        try:
            connection.close()
            _settle(supervisor)
            _live(work, other)
        finally:
            os._exit(0)
    other.close()
    return _Process(number, pid, connection)


def _settle(supervisor: int) -> None:
    """Hear of Ctrl-C from the supervisor alone, and end with it."""
    os.setpgid(0, 0)
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != supervisor:
        os._exit(0)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _live(work: Work, connection: Connection) -> None:
    from harness.process.task import Forward

    def warned(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        connection.send(_Warned(message if isinstance(message, Warning) else category(message)))

    sys.stdout, sys.stderr = (Forward(connection.send, name) for name in ("stdout", "stderr"))
    warnings.showwarning = warned
    try:
        done = Done(work(lambda *told: connection.send(told)))
    except BaseException as fault:
        done = Done(fault=packed(fault))
    sys.stdout.flush()
    sys.stderr.flush()
    connection.send(done)


def _take(process: _Process, hear: Callable[..., object]) -> None:
    try:
        message = process.connection.recv()
    except (EOFError, OSError):
        code = _end(process)
        process.ended = Ended(fault=SimulationError(f"a process of the run ended with code {code}"))
        return
    match message:
        case Printed() | _Warned():
            process.unheard.append(message)
        case Done():
            _end(process)
            fault = unpacked(message.fault) if message.fault else None
            process.ended = Ended(message.value, fault)
        case _:
            hear(process.number, *message)


def _end(process: _Process, by: int = 0) -> int:
    """Wait for its end, which `by` brings about; its exit code, or minus the signal."""
    with suppress(ProcessLookupError):
        if by:
            os.kill(process.pid, by)
    process.connection.close()
    return os.waitstatus_to_exitcode(os.waitpid(process.pid, 0)[1])


def _let_hear(processes: Sequence[_Process]) -> None:
    """What was said by the works that are done, and by the first that is not."""
    for process in processes:
        for said in process.unheard:
            if isinstance(said, _Warned):
                warnings.warn(said.message, stacklevel=2)
            else:
                getattr(sys, said.stream).write(said.text)
        process.unheard.clear()
        if process.ended is None:
            return


def _interrupt(processes: Sequence[_Process]) -> BaseException | None:
    """What the interrupt was in the first work that it met."""
    faults = (process.ended.fault for process in processes if process.ended is not None)
    return next((one for one in faults if isinstance(one, KeyboardInterrupt)), None)
