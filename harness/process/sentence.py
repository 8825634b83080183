"""How a worker's death is told: one sentence with component, file, call, time and what was said."""

from __future__ import annotations

import signal
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from harness.participants.driven import function_name
from harness.process.limits import Limits, show_memory
from harness.process.marker import LOOPING, WORKING, Where
from harness.process.messages import Linked

_MEANINGS = {
    signal.SIGSEGV: "an access to memory that is not its own, or a stack overflow",
    signal.SIGABRT: "it gave up",
    signal.SIGBUS: "a bus error",
    signal.SIGFPE: "an arithmetic fault",
    signal.SIGILL: "an illegal instruction",
    signal.SIGKILL: "it was killed from outside, perhaps because memory ran out",
}


@dataclass
class Calls:
    """Who is who: the FMU files by component (or the only one), and the operations of the loop."""

    files: Mapping[str, Path] | Path | None = field(default_factory=dict)
    linked: Linked | None = None

    def place(self, where: Where) -> str:
        """Component, file, call and time, as far as they are known."""
        component, call, time = where.component, where.call, where.reached
        if self.linked is not None:
            now = where.now_ns / self.linked.ticks_per_second
            time = now if time is None else max(now, time)
            if where.place == LOOPING:
                component, call = self.linked.calls[where.operation]
                call = function_name(where.function) or call
        when = "" if time is None else f" at t = {time:.9g} s"
        if not call:
            return f"the worker process{when}"
        path = self.files.get(component) if isinstance(self.files, Mapping) else self.files
        file = f" ({path})" if path is not None else ""
        owner = f"component {component}{file}: " if component else ""
        return f"{owner}{call}{when}"


def death(calls: Calls, where: Where, code: int | None, log: list[str]) -> str:
    """The sentence for a worker that ended with `code` (minus a signal) without being asked to."""
    ended = "ended" if where.place == WORKING else "ended the process"
    if code is None or code >= 0:
        how = ended if code is None else f"{ended} as by exit({code})"
    else:
        how = f"crashed with {_signal_name(-code)}"
    return f"{calls.place(where)} {how}{_said(log)}"


def excess(
    limit: str, calls: Calls, where: Where, limits: Limits, held: int, log: list[str]
) -> str:
    """The sentence for a worker that was ended beyond `limit`, "call", "run" or "memory", when it
    held so many bytes."""
    place, most = calls.place(where), limits.memory_bytes or 0
    match limit:
        case "call":
            return (
                f"{place} had not returned after {limits.call:g} s and was ended; if it needs "
                f"longer, raise the limit (call in [limits], or --call-timeout){_said(log)}"
            )
        case "run":
            return (
                f"the run had not ended after {limits.run:g} s and was ended in {place}; if it "
                "needs longer, raise the limit (run in [limits], or --run-timeout)"
            )
    return (
        f"{place} was ended because the run held {show_memory(held)} of memory, more than its "
        f"limit of {show_memory(most)} (memory in [limits], or --memory-limit){_said(log)}"
    )


def _said(log: list[str]) -> str:
    """The last messages of FMUs, as the end of a sentence."""
    return "; last messages: " + " | ".join(log) if log else ""


def _signal_name(number: int) -> str:
    try:
        name = signal.Signals(number)
    except ValueError:
        return f"signal {number}"
    meaning = _MEANINGS.get(name)
    return name.name + (f" ({meaning})" if meaning else "")
