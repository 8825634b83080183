"""A worker process: started, watched for its end, ended with all that it started.

The worker is forked, so that closures, blocks and loaded machine code go over as they are and it
is there within milliseconds. It has a process group, a temporary folder and no standard input of
its own, leaves no core dump, and dies with its supervisor. A janitor, a shell that waits for the
supervisor's end, removes the folder where the supervisor was killed.

Only Linux is served: elsewhere forking is unsafe or unknown, and runs stay in their process.
"""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from harness.errors import HarnessError

_JANITOR = 'read -r worker; read -r _; [ -n "$worker" ] && kill -9 -- "-$worker"; rm -rf -- "$1"'
PR_SET_PDEATHSIG = 1
_DYING_SECONDS = 1.0

_inside = False


def available() -> bool:
    """Whether a worker can be started here: on Linux, and not inside a worker."""
    return sys.platform == "linux" and not _inside


def already_isolated() -> None:
    """This process is a worker of its own kind, as those of a study: its runs stay in it."""
    global _inside
    _inside = True


def memory_of(pid: int) -> int:
    """Bytes of memory that a process holds; 0 where it is gone or cannot be asked."""
    try:
        held = Path(f"/proc/{pid}/statm").read_text().split()[1]
    except (OSError, IndexError):
        return 0
    return int(held) * os.sysconf("SC_PAGE_SIZE")


class WorkerProcess:
    """A forked worker that runs `work(connection)`; `connection` is the supervisor's end."""

    def __init__(self, work: Callable[[Connection], None]) -> None:
        try:
            self.folder = Path(tempfile.mkdtemp(prefix="fmu-harness-run-"))
        except OSError as fault:
            raise HarnessError(
                f"no temporary folder can be made in {tempfile.gettempdir()}: "
                f"{fault.strerror or fault}; make room there, or set TMPDIR to another folder"
            ) from fault
        reading, self._lifeline = os.pipe()  # ends when the last process that holds it does
        self._janitor = _janitor(self.folder, reading)  # first, so that no moment lacks one
        os.close(reading)
        self.connection, other = Pipe()
        sys.stdout.flush()
        sys.stderr.flush()
        supervisor = os.getpid()
        self._inherited = memory_of(supervisor)
        with compiler_at_rest():
            self.pid = os.fork()
        if self.pid == 0:
            os.close(self._lifeline)
            _live(work, other, self.connection, self.folder, supervisor)
        other.close()
        with contextlib.suppress(OSError):  # the worker does the same; whoever comes first
            os.setpgid(self.pid, self.pid)
        with contextlib.suppress(OSError):
            os.write(self._lifeline, f"{self.pid}\n".encode())

    def held(self) -> int:
        """Bytes of memory that it holds besides what it has been forked with."""
        return max(0, memory_of(self.pid) - self._inherited)

    def gone(self) -> bool:
        """Whether it has ended; what an FMU of it started may still hold its end of the pipe."""
        try:
            ended = os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        except ChildProcessError:  # somebody else has waited for it
            return True
        return ended is not None

    def end(self, *, at_once: bool) -> int | None:
        """End the worker and all that it started; its exit code, or minus the signal that ended
        it, or None where that is not known. Not `at_once`: it may take a moment to end itself."""
        if not at_once:
            self._wait(_DYING_SECONDS)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, signal.SIGKILL)
        try:
            code: int | None = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        except ChildProcessError:  # somebody else has waited for it
            code = None
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, signal.SIGKILL)  # what it started while it was dying
        shutil.rmtree(self.folder, ignore_errors=True)
        if self._janitor is not None:
            self._janitor.kill()
            self._janitor.wait()
        os.close(self._lifeline)
        return code

    def _wait(self, seconds: float) -> None:
        """Until the worker has ended, but no longer; it stays to be waited for."""
        until = time.monotonic() + seconds
        while not self.gone() and time.monotonic() < until:
            time.sleep(0.002)


def compiler_at_rest() -> AbstractContextManager[Any]:
    """While open, no other thread compiles: what it held would stay locked in the worker."""
    if "numba" not in sys.modules:
        return contextlib.nullcontext()
    from numba.core.compiler_lock import global_compiler_lock

    lock: AbstractContextManager[Any] = global_compiler_lock
    return lock


def _janitor(folder: Path, lifeline: int) -> subprocess.Popen[bytes] | None:
    command = ["/bin/sh", "-c", _JANITOR, "fmu-harness-janitor", str(folder)]
    quiet = subprocess.DEVNULL
    try:
        return subprocess.Popen(
            command, stdin=lifeline, stdout=quiet, stderr=quiet, cwd="/", start_new_session=True,
        )  # fmt: skip
    except OSError:  # no shell: only a killed supervisor leaves its folder behind
        return None


def _live(
    work: Callable[[Connection], None],
    connection: Connection,
    other: Connection,
    folder: Path,
    supervisor: int,
) -> None:
    """The worker's whole life; never returns into the stack that it has a copy of."""
    try:
        other.close()
        _settle(folder, supervisor)
        work(connection)
    finally:
        os._exit(0)


def _leave_at_once_on_exit() -> None:
    """An FMU that calls exit() ends the worker, and nothing that the supervisor's libraries have
    registered for their own end is done in this copy of it: the last one registered is the first
    to run, and it leaves."""
    library = ctypes.CDLL(None)
    if hasattr(library, "on_exit"):  # of the GNU library
        library.on_exit(library._exit, None)


def _settle(folder: Path, supervisor: int) -> None:
    already_isolated()
    with contextlib.suppress(OSError):
        os.setpgid(0, 0)
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != supervisor:
        os._exit(0)
    _leave_at_once_on_exit()
    faulthandler.disable()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.close(null)
    tempfile.tempdir = os.environ["TMPDIR"] = str(folder)
    with contextlib.suppress(OSError):  # where memory ends, the worker goes before its supervisor
        Path("/proc/self/oom_score_adj").write_text("1000")
