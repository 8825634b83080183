"""Independent tasks over processes, results as they come.

The matrices here are small, so threads of a linear algebra library only wait for each other:
a process gets one, unless the environment says otherwise.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Self, TypeVar

from harness.errors import SimulationError
from harness.process.fork import available, compiler_at_rest
from harness.process.watchdog import watch_over_runs

Task = TypeVar("Task")
Outcome = TypeVar("Outcome")

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Read by the libraries when they are loaded, so they must be set before a process starts."""


class Workers:
    """`count` processes (0 asked for: one a core), started when first needed and then kept, for
    what they have loaded and compiled. A context manager; one worker works here, unless all is
    to be `isolated` from this process.

    Processes are spawned, so a script that makes them needs `if __name__ == "__main__":`; one that
    is `forked` has what this process has loaded, and needs nothing."""

    def __init__(self, jobs: int = 0, *, isolated: bool = False, forked: bool = False) -> None:
        """Starts nothing."""
        self.count = jobs or os.cpu_count() or 1
        self._method = "fork" if forked else "spawn"
        self._here = self.count <= 1 and not isolated
        self._pool: ProcessPoolExecutor | None = None

    def spread(
        self,
        function: Callable[[Task], Outcome],
        tasks: Sequence[Task],
        *,
        careful: Callable[[Task], Outcome] | None = None,
    ) -> Iterator[tuple[Task, Outcome]]:
        """Pairs (task, function(task)) in the order in which they are done. The function and the
        tasks must be picklable. The first task is done before the others begin, so that what it
        builds and compiles is there for all.

        When a process dies, as an FMU that crashes or hangs makes it, the tasks that may have been
        at it are done here by `careful`, which must withstand it; the others go on in new
        processes. Without it `SimulationError` is raised. Tasks not yet begun are dropped when the
        caller stops asking.
        """
        if self._here:
            yield from ((task, function(task)) for task in tasks)
            return
        for some in (tasks[:1], tasks[1:]):
            left = list(some)
            while left:
                suspects: list[Task] = []
                for task, outcome in self._until_broken(function, left, suspects):
                    left.remove(task)
                    yield task, outcome
                if suspects and careful is None:
                    raise SimulationError(
                        "a process of the study died; which task ended it is not known"
                    )
                for task in suspects:
                    assert careful is not None
                    left.remove(task)
                    yield task, careful(task)

    def _until_broken(
        self, function: Callable[[Task], Outcome], tasks: Sequence[Task], suspects: list[Task]
    ) -> Iterator[tuple[Task, Outcome]]:
        """What is done before a process dies; then `suspects` are the tasks that had begun."""
        futures = self._submit(function, tasks)
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        except BrokenProcessPool:
            self.close()
            lost = [t for f, t in futures.items() if isinstance(f.exception(), BrokenProcessPool)]
            suspects += lost[: 2 * self.count + 1]  # at most so many are with the processes
        finally:
            for future in futures:
                future.cancel()

    def _submit(
        self, function: Callable[[Task], Outcome], tasks: Sequence[Task]
    ) -> dict[Future[Outcome], Task]:
        if self._pool is None:
            context = get_context(self._method)
            self._pool = ProcessPoolExecutor(self.count, context, watch_over_runs)
        # processes start at a submission
        with _defaults(dict.fromkeys(ONE_THREAD, "1")), compiler_at_rest(), _deaf_to_interrupts():
            return {self._pool.submit(function, task): task for task in tasks}

    def abandon(self) -> None:
        """End the processes at once, whatever they are at."""
        if self._pool is not None:
            processes = getattr(self._pool, "_processes", None) or {}  # the pool has no call for it
            for process in list(processes.values()):
                process.kill()
        self.close()

    def close(self) -> None:
        """End the processes, each after the task that it is at."""
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@contextmanager
def given_or_one(workers: Workers | None) -> Iterator[Workers]:
    """The workers given, which stay open; else one process apart from this one, where the system
    has such."""
    if workers is not None:
        yield workers
        return
    with Workers(1, isolated=available(), forked=True) as one:
        yield one


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Processes that start while this is open leave Ctrl-C to their parent from their first moment
    on; here it is heard afterwards."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _defaults(variables: dict[str, str]) -> Iterator[None]:
    """While open, the environment has these variables where it did not have them before."""
    new = {name: value for name, value in variables.items() if name not in os.environ}
    os.environ.update(new)
    try:
        yield
    finally:
        for name in new:
            del os.environ[name]
