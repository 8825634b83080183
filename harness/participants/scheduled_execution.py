"""Scheduled execution of FMI 3: the importer activates model partitions, each by its input clock.

Partitions run one after the other, so none is ever preempted: at equal times by priority (the lower
number first), otherwise in order of time. A communication step activates what ticks after its
start and up to its end, with the inputs that it began with; what ticks at the start of the run is
activated when initialisation ends. A partition that a wire triggers is activated at the start of
the step. Countdown clocks are asked for their intervals and output clocks whether they tick after
an activation that has called clockUpdate. Values that depend on a clock are read right after its
partition and held until the next time; ticks are rows, those at the end of a step the loop's own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from harness.compiler import operations as op
from harness.errors import SimulationError
from harness.fmi.binding.fmi3 import Fmi3Instance
from harness.fmi.binding.interface import SCHEDULED_EXECUTION
from harness.participants.driven import DrivenParticipant
from harness.participants.events import FULL
from harness.participants.fmu import FmuParticipant
from harness.participants.memory import Row

_MOST_AT_ONCE = 1000


class ScheduledExecution(DrivenParticipant):
    """An FMU whose partitions are activated on the calendar of the run."""

    kind = SCHEDULED_EXECUTION
    instance: Fmi3Instance
    has_events = False

    def leave_initialization(self, time: float) -> None:
        """Exit initialisation mode, and activate what ticks at the start."""
        FmuParticipant.leave_initialization(self, time)
        self.clocks.begin()
        self.hook.triggered = ()
        self._last = time
        self._activate(self.clocks.due(time), time)

    # rows

    def write(self, inputs: Sequence[str]) -> Iterator[Row]:
        """Set inputs, and look which clocks are triggered."""
        rest = self.unclocked(inputs)
        if len(rest) < len(inputs):
            yield self.calling(self.look_for_triggers)
        yield from super().write(rest)

    def step(self, ticks: int, final: bool) -> Iterator[Row]:
        """Activate what ticks in that time."""
        yield self.stepping(self._step, ticks)

    def remembered(self) -> dict[str, Any]:
        """What the importer must remember with a snapshot of the FMU."""
        return super().remembered() | {"last tick": float(self._last)}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from where the FMU and `memory` come from; inputs are set anew."""
        super().recall(memory)
        self._last = memory["last tick"]
        self.inputs.forget()

    # steps

    def advance(self, start: float, target: float) -> None:
        """The same step outside the loop; raises `HarnessError`."""
        self._last = start
        self._step(0, start, target)

    def _step(self, unused: int, start: float, target: float) -> int:
        """Go on behind the last tick; a step that is taken up again has been there already."""
        self.hook.forget_ticks()
        if self._full:
            return FULL
        if self.hook.triggered:
            triggered, self.hook.triggered = self.hook.triggered, ()
            self._activate(triggered, start)
        while (tick := self.clocks.next(self._last)) <= target:
            if self._full:
                return FULL
            self._activate(self.clocks.due(tick), tick)
            self._last = tick
            if tick < target:
                self._row(tick)
        self.inputs.apply(self.instance, target)
        return 0

    @property
    def _full(self) -> bool:
        return bool(self._room[0] < int(self.memory.clock[op.ROWS]) + 2)

    def _row(self, time: float) -> None:
        self.hook.observe(time)
        self.hook.forget_ticks()

    def _activate(self, names: Sequence[str], time: float) -> None:
        """Activate partitions by priority, and those that they start with no delay."""
        self.inputs.apply(self.instance, time)
        waiting, clocks, instance = list(names), self.clocks, self.instance
        for _ in range(_MOST_AT_ONCE):
            if not waiting:
                return
            name = min(waiting, key=self._urgency)
            waiting.remove(name)
            updates = instance.clock_updates
            instance.activate(name, time)
            clocks.ticked((name,), time)
            active = {name: True}
            if instance.clock_updates != updates:
                clocks.count_down(time)
                active |= {output: bool(instance.get(output)) for output in clocks.outputs}
            self.hook.hold(active)
            waiting += [one for one in clocks.due_now(time) if one not in waiting]
        raise SimulationError(
            f"component {self.name}: more than {_MOST_AT_ONCE} activations at t = {time:.9g} s, "
            f"the last one of {name!r}: countdown clocks start each other without delay, and time "
            "stands still"
        )

    def _urgency(self, clock: str) -> tuple[float, int]:
        """By priority, those without one last, and in the order of the description."""
        priority = self.clocks.inputs[clock].details.priority
        order = list(self.clocks.inputs).index(clock)
        return float("inf") if priority is None else priority, order
