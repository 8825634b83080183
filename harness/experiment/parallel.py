"""Independent tasks over processes, results as they come."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from typing import TypeVar

from harness.experiment.persistence import DeadProcessError, until_all_are_done

Task = TypeVar("Task")
Outcome = TypeVar("Outcome")


def spread(
    function: Callable[[Task], Outcome], tasks: Sequence[Task], jobs: int = 0
) -> Iterator[tuple[Task, Outcome]]:
    """Pairs (task, function(task)) in the order in which they are done, from `jobs` processes
    (0: one a core). The function and the tasks must be picklable. What a process was at when it
    died is done again in another one, a few times.

    Raises `DeadProcessError` when that does not help. Tasks not yet begun are dropped when the
    caller stops asking.
    """
    workers = min(jobs or os.cpu_count() or 1, len(tasks))
    if workers <= 1:
        for task in tasks:
            yield task, function(task)
        return
    yield from until_all_are_done(partial(_one_round, function, workers), tasks)


def _one_round(
    function: Callable[[Task], Outcome], workers: int, tasks: Sequence[Task]
) -> Iterator[tuple[Task, Outcome]]:
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
    try:
        futures = {pool.submit(function, task): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as fault:
        raise DeadProcessError(
            "a process of the study died; run the experiment without --study or --sweep to see "
            "which component ends it"
        ) from fault
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
