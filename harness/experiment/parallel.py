"""Independent tasks over processes, results as they come."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import TypeVar

from harness.errors import SimulationError

Task = TypeVar("Task")
Outcome = TypeVar("Outcome")


def spread(
    function: Callable[[Task], Outcome], tasks: Sequence[Task], jobs: int = 0
) -> Iterator[tuple[Task, Outcome]]:
    """Pairs (task, function(task)) in the order in which they are done, from `jobs` processes
    (0: one a core). The function and the tasks must be picklable.

    Raises `SimulationError` when a process dies, as a crashing FMU makes it; the task that was
    running then is not known. Tasks not yet begun are dropped when the caller stops asking.
    """
    workers = min(jobs or os.cpu_count() or 1, len(tasks))
    if workers <= 1:
        for task in tasks:
            yield task, function(task)
        return
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
    try:
        futures = {pool.submit(function, task): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as fault:
        raise SimulationError(
            "a process of the study died; run the experiment without --study or --sweep to see "
            "which component ends it"
        ) from fault
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
