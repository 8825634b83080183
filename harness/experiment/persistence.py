"""Independent tasks done to the last one although processes die.

A process may be killed from outside, when memory runs out or by a nervous administrator. What the
others have finished stays, and what was under way is done again in new processes; since tasks are
pure, the results are those of an undisturbed run. A task whose process dies again and again, with
nothing else left to be done, is given up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from harness.errors import SimulationError

Task = TypeVar("Task")
Outcome = TypeVar("Outcome")

FRUITLESS_ROUNDS = 3


class DeadProcessError(SimulationError):
    """A process died before it had finished its task."""


def until_all_are_done(
    round_of: Callable[[Sequence[Task]], Iterator[tuple[Task, Outcome]]], tasks: Sequence[Task]
) -> Iterator[tuple[Task, Outcome]]:
    """Pairs (task, outcome), each task once, from as many rounds as it takes.

    `round_of(tasks)` gives pairs as they come and raises `DeadProcessError` when a process dies.
    Raises it too after `FRUITLESS_ROUNDS` in which nothing was finished.
    """
    left = list(tasks)
    fruitless = 0
    while left:
        before = len(left)
        try:
            for task, outcome in round_of(tuple(left)):
                left = [one for one in left if one is not task]
                yield task, outcome
        except DeadProcessError as fault:
            fruitless = fruitless + 1 if len(left) == before else 0
            if fruitless >= FRUITLESS_ROUNDS:
                raise DeadProcessError(
                    f"{fault}; {len(left)} of {len(tasks)} tasks were not finished, although they "
                    f"were begun {FRUITLESS_ROUNDS} times"
                ) from fault
