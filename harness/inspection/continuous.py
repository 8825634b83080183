"""The checks that only model exchange has: states, their nominal values, event indicators."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.inspection.finding import Finding, claimed, failed, passed, require
from harness.inspection.subject import Subject
from harness.inspection.trial import running

_SHIFT = 1e-3  # of a state's nominal value


def returns_states(subject: Subject) -> Finding:
    """States that were set are read back to the last bit, at the start and later."""
    flag = "set and get of the continuous states"
    with running(subject) as trial:
        part = trial.part
        require(part.nx, "no continuous states")
        for steps in (0, subject.half):
            trial.advance(steps)
            if trial.ended:
                break
            x = part.states()
            for wanted in (x, x + _SHIFT * part.nominals(), x):
                with claimed(flag):
                    part.set_states(wanted)
                    found = part.states()
                other = wanted.view(np.uint64) != found.view(np.uint64)
                if other.any():
                    i, name = _first(subject, other)
                    said = f"{name} was set to {wanted[i]:.17g} and is {found[i]:.17g}"
                    return failed(said, flag)
    return passed(f"{part.nx} states, bit for bit")


def _first(subject: Subject, states: NDArray[np.bool_]) -> tuple[int, str]:
    """The place of the first of the states that are marked, and its name."""
    i = int(np.argmax(states))
    return i, subject.labels[len(subject.labels) - 2 * len(states) + i]


def has_positive_nominals(subject: Subject) -> Finding:
    """Nominal values scale the solver's tolerances, so they must be positive and finite."""
    with running(subject) as trial:
        part = trial.part
        require(part.nx, "no continuous states")
        nominal = part.stated_nominals()
    bad = ~(np.isfinite(nominal) & (nominal > 0.0))
    if bad.any():
        i, name = _first(subject, bad)
        return failed(f"that of {name} is {nominal[i]:g}", "nominals of the continuous states")
    return passed(f"from {nominal.min():g} to {nominal.max():g}")


def has_finite_indicators(subject: Subject) -> Finding:
    """Event indicators are numbers all along the run."""
    with running(subject) as trial:
        part = trial.part
        require(part.nz, "no event indicators")
        for step in range(subject.steps):
            z = part.indicators()
            if not np.isfinite(z).all():
                i = int(np.argmax(~np.isfinite(z)))
                time = subject.start + step * subject.step
                return failed(f"number {i + 1} is {z[i]} at t = {time:.9g} s", "event indicators")
            trial.advance(1, first=step)
            if trial.ended:
                break
    return passed(f"{part.nz}, all along the run")
