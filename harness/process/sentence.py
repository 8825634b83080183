"""How a worker's death is told: one sentence with component, file, call, time and what was said."""

from __future__ import annotations

import signal
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.clock import to_seconds
from harness.process.limits import Limits, show_memory
from harness.process.marker import CALLING, LOOPING, Where
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
    """Who is who: FMU files by component, or the `only` one, and what each operation of the
    program is."""

    files: Mapping[str, Path] = field(default_factory=dict)
    linked: Linked | None = None
    only: Path | None = None

    def place(self, where: Where) -> str:
        """Component, file, call and time, as far as they are known."""
        component, call, when = where.component, where.call, ""
        if where.place == LOOPING and self.linked is not None:
            index = np.frombuffer(self.linked.index, dtype=np.int32)
            component, call = self.linked.calls[int(index[where.operation])]
        if self.linked is not None:
            when = f" at t = {to_seconds(where.now_ns):.9g} s"
        elif where.reached is not None:
            when = f" at t = {where.reached:.9g} s"
        if not call:
            return f"the worker process{when}"
        path = self.files.get(component, self.only)
        file = f" ({path})" if path is not None else ""
        owner = f"component {component}{file}: " if component else ""
        return f"{owner}{call}{when}"

    def inside_foreign_code(self, where: Where) -> bool:
        """Whether a call was under way, not the harness' own work."""
        return where.place in (CALLING, LOOPING)


def death(calls: Calls, where: Where, code: int | None, log: list[str]) -> str:
    """The sentence for a worker that ended with `code` (minus a signal) without being asked to."""
    place = calls.place(where)
    if code is None or code == 0:
        how = "ended the process as by exit(0)" if code == 0 else "ended the process"
    elif code > 0:
        how = f"ended the process as by exit({code})"
    else:
        how = f"crashed with {_signal_name(-code)}"
    if not calls.inside_foreign_code(where):
        how = how.replace("ended the process", "ended")
    return f"{place} {how}{said(log)}"


def overdue(calls: Calls, where: Where, limits: Limits, log: list[str]) -> str:
    """The sentence for a call that does not come back."""
    return (
        f"{calls.place(where)} had not returned after {limits.call:g} s and was ended; if it needs "
        f"longer, raise the limit (call in [limits], or --call-timeout){said(log)}"
    )


def too_long(calls: Calls, where: Where, limits: Limits) -> str:
    """The sentence for a run that exceeds its time."""
    return (
        f"the run had not ended after {limits.run:g} s and was ended in {calls.place(where)}; if "
        "it needs longer, raise the limit (run in [limits], or --run-timeout)"
    )


def too_big(calls: Calls, where: Where, held: int, limit: int, log: list[str]) -> str:
    """The sentence for a worker that holds too much memory."""
    return (
        f"{calls.place(where)} was ended because the run held {show_memory(held)} of memory, more "
        f"than its limit of {show_memory(limit)} (memory in [limits], or --memory-limit){said(log)}"
    )


def said(log: list[str]) -> str:
    """The last messages of FMUs, as the end of a sentence."""
    return "; last messages: " + " | ".join(log) if log else ""


def _signal_name(number: int) -> str:
    try:
        name = signal.Signals(number)
    except ValueError:
        return f"signal {number}"
    meaning = _MEANINGS.get(name)
    return name.name + (f" ({meaning})" if meaning else "")
