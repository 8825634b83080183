"""Event handling: set inputs and clocks, iterate the discrete states, look ahead to time events."""

from __future__ import annotations

import math
from dataclasses import dataclass

from harness.errors import SimulationError
from harness.fmi.binding.instance import FmuInstance
from harness.participants.grid import is_close
from harness.simulation.clocks import Clocks
from harness.simulation.inputs import Inputs
from harness.simulation.outputs import Recorder

MOST_ITERATIONS = 1000
MOST_EVENTS_AT_ONCE = 1000


@dataclass(frozen=True)
class EventOutcome:
    """What an event led to; `next_time` is that of the next time event (s), or infinity."""

    terminate: bool
    nominals_changed: bool
    next_time: float


class EventHandler:
    """Handles the events of one instance."""

    def __init__(
        self, instance: FmuInstance, inputs: Inputs, clocks: Clocks, recorder: Recorder
    ) -> None:
        """`recorder` reads what depends on clocks while they are active."""
        self.instance, self.inputs = instance, inputs
        self.clocks, self.recorder = clocks, recorder
        self._last, self._repeats = 0.0, 0

    def initial(self, time: float) -> EventOutcome:
        """The event at the end of initialisation; the instance is in event mode already."""
        self.clocks.begin()
        outcome = self._iterate(time)
        self.instance.leave_event_mode()
        return outcome

    def handle(self, time: float) -> EventOutcome:
        """Enter event mode, handle the event at `time` (s), and leave it."""
        self._check_progress(time)
        self.instance.enter_event_mode()
        self.inputs.apply(self.instance, time, after=True)
        outcome = self._iterate(time)
        if not outcome.terminate:
            self.instance.leave_event_mode()
        return outcome

    def _iterate(self, time: float) -> EventOutcome:
        nominals = False
        ticking = self.clocks.due(time)
        for _ in range(MOST_ITERATIONS):
            self.instance.set(dict.fromkeys(ticking, True))
            self._read_clocks(ticking)
            self.clocks.ticked(ticking, time)
            states = self.instance.update_discrete_states()
            nominals = nominals or states.nominals_changed
            if states.terminate:
                return EventOutcome(True, nominals, math.inf)
            self.clocks.count_down(time)
            ticking = tuple(n for n in self.clocks.due_now(time) if n not in ticking)
            if not states.needs_update and not ticking:
                ahead = math.inf if states.next_event_time is None else states.next_event_time
                return EventOutcome(False, nominals, ahead)
        raise SimulationError(
            f"component {self.instance.name}: the event at t = {time:.9g} s does not settle in "
            f"{MOST_ITERATIONS} iterations of its discrete states"
        )

    def _read_clocks(self, ticking: tuple[str, ...]) -> None:
        names = self.recorder.clocked_names
        if not names:
            return
        active = dict.fromkeys(ticking, True)
        for name in self.clocks.outputs:
            active[name] = bool(self.instance.get(name))
        self.recorder.hold(active)

    def _check_progress(self, time: float) -> None:
        self._repeats = self._repeats + 1 if is_close(time, self._last, 1e-3) else 0
        self._last = time
        if self._repeats > MOST_EVENTS_AT_ONCE:
            raise SimulationError(
                f"component {self.instance.name}: more than {MOST_EVENTS_AT_ONCE} events at "
                f"t = {time:.9g} s, one after the other: the model chatters, and time stands still"
            )
