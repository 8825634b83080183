"""Jacobi: all FMUs step from the values of the beginning of the step, in any order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.master.algorithms.base import Algorithm
from harness.master.plan.actions import Action, Step


class Jacobi(Algorithm):
    """All FMUs take the values of the beginning of the step."""

    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        """All extrapolate, all write, all step."""
        yield from self.look_ahead(due)
        yield from self.write(due)
        yield from (Step(name, step_ns) for name, step_ns in due.items())
