"""Gauss–Seidel: FMUs step one after the other; each takes what those before it have reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.master.algorithms.base import AHEAD, Algorithm, Terms
from harness.master.plan.actions import Action, Blend, Read, Step, Transfer
from harness.system.lowering import Wire

CHANGE_REACHED: Terms = (("reached", 1.0), ("present", -1.0))
"""From the value at the beginning of a step to that at its end."""


class GaussSeidel(Algorithm):
    """FMUs step in the order of the components."""

    def knows_end(self, wire: Wire) -> bool:
        """Of the FMUs that step before."""
        order = list(self.step_ns)
        return order.index(wire.source.component) < order.index(wire.target.component)

    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        """One FMU after the other."""
        for name in self.step_ns:
            if name in due:
                yield from self.in_turn(name, due[name])

    def in_turn(self, name: str, step_ns: int) -> Iterator[Action]:
        """One FMU steps, and what those after it need is read."""
        earlier = [wire for wire in self.wires_to[name] if self.knows_end(wire)]
        yield from self._look_back(earlier)
        yield from self.look_ahead([name])
        yield from self.write([name])
        yield Step(name, step_ns)
        if name in self.reached:
            between, _ = self.parted(self.feeding(wire for wire in earlier if wire.linear))
            ahead, _ = self.parted(self.feeding(self.ahead(name)))
            if between:
                yield Blend(between, 2.0, (("present", -1.0),))
            if ahead:
                yield Blend(ahead, 1.0, AHEAD)
            if between or ahead:
                yield from self.write([name])
            yield Read(name, self.reached[name], "reached")

    def _look_back(self, wires: list[Wire]) -> Iterator[Action]:
        """Take from FMUs that have stepped what they have reached."""
        held = tuple(wire for wire in wires if not wire.linear)
        if held:
            yield Transfer(held, "reached")
        middle, sloped = self.parted(wire for wire in wires if wire.linear)
        if middle:
            yield Blend(middle, 0.5, (("reached", 0.5),))
        yield from self.slopes(sloped, 0.0, CHANGE_REACHED)
