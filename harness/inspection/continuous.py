"""The checks that only model exchange has: states, their nominal values, event indicators."""

from __future__ import annotations

import numpy as np

from harness.errors import HarnessError
from harness.inspection.finding import Finding, failed, not_offered, passed
from harness.inspection.subject import Array, Subject

_SHIFT = 1e-3  # of a state's nominal value


def returns_states(subject: Subject) -> Finding:
    """States that were set are read back to the last bit, at the start and later."""
    flag = "set and get of the continuous states"
    with subject.running() as trial:
        part = trial.part
        if not part.nx:
            return not_offered("no continuous states")
        for steps in (0, subject.half):
            trial.advance(steps)
            if trial.ended:
                break
            x = part.states()
            for wanted in (x, x + _SHIFT * part.nominals(), x):
                try:
                    trial.instance.check(part.set_states(wanted.ctypes.data), "SetContinuousStates")
                    found = part.states()
                except HarnessError as fault:
                    return failed(str(fault), flag)
                if wanted.tobytes() != found.tobytes():
                    return failed(_first(subject, wanted, found), flag)
    return passed(f"{part.nx} states, bit for bit")


def _first(subject: Subject, wanted: Array, found: Array) -> str:
    i = int(np.argmax(wanted.view(np.uint64) != found.view(np.uint64)))
    name = subject.labels[len(subject.labels) - 2 * len(wanted) + i]
    return f"{name} was set to {wanted[i]:.17g} and is {found[i]:.17g}"


def has_positive_nominals(subject: Subject) -> Finding:
    """Nominal values scale the solver's tolerances, so they must be positive and finite."""
    with subject.running() as trial:
        part = trial.part
        if not part.nx:
            return not_offered("no continuous states")
        nominal = part.stated_nominals()
    bad = ~(np.isfinite(nominal) & (nominal > 0.0))
    if bad.any():
        i = int(np.argmax(bad))
        name = subject.labels[len(subject.labels) - 2 * part.nx + i]
        return failed(f"that of {name} is {nominal[i]:g}", "nominals of the continuous states")
    return passed(f"from {nominal.min():g} to {nominal.max():g}")


def has_finite_indicators(subject: Subject) -> Finding:
    """Event indicators are numbers all along the run."""
    with subject.running() as trial:
        part = trial.part
        if not part.nz:
            return not_offered("no event indicators")
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
