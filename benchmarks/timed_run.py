"""A run through the library, timed: processor time per instant, without what comes before it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from harness.master.opened import opened
from harness.master.recorded import columns_of
from harness.master.run import execute, plan_system
from harness.results.recording import Recording
from harness.results.result import Result
from harness.system.graph import System


@dataclass(frozen=True)
class TimedRun:
    """Nanoseconds per cycle of the plan; seconds for planning; what was recorded."""

    nanoseconds: float
    planning: float
    result: Result


class _Stopwatch:
    """Notes when the first and the last chunk of a run ended."""

    def __init__(self) -> None:
        self.marks: list[tuple[float, float]] = []

    def __call__(self, share: float) -> None:
        self.marks = [*self.marks[:1], (share, time.thread_time())]

    def nanoseconds(self, cycles: int) -> float:
        """Between those two moments, for one of `cycles`."""
        (first, began), (last, ended) = self.marks
        return 1e9 * (ended - began) / ((last - first) * cycles)


def timed_run(system: System, record: tuple[str, ...] = ("*",)) -> TimedRun:
    """Plan and execute with rows kept in memory, with everything that a run does.

    From the end of the first chunk on (64 cycles), so that neither loading nor compiling counts;
    the run must be longer than that.
    """
    stopwatch = _Stopwatch()
    with opened(system) as fmus:
        began = time.thread_time()
        plan = plan_system(system, fmus, record)
        planning = time.thread_time() - began
        with Recording(columns_of(plan, fmus)) as recording:
            outcome = execute(plan, fmus, recording, progress=stopwatch)
            result = recording.finish()
    if outcome.fault is not None:
        raise outcome.fault
    cycles = (system.stop_ns - system.start_ns) // plan.cycle_ns + 1
    return TimedRun(stopwatch.nanoseconds(cycles), planning, result)
