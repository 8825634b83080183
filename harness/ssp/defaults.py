"""Times for systems that state none, each said aloud: SSP itself knows start and stop only.

In this order: our own settings, the description's default experiment, a fixed-step algorithm in
another tool's annotation, what the FMUs say of themselves, and at last a thousandth of a second's
run. Where FMUs have fixed internal steps, the step is the longest of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from warnings import warn

from harness.clock import nearest_nanosecond
from harness.fmi.description.model_description import ModelDescription
from harness.ssp.document import SystemStructure
from harness.ssp.settings import fixed_step

_LENGTH = 1.0
_STEPS = 1000


def times(
    structure: SystemStructure,
    given: Mapping[str, Any],
    fmus: Mapping[str, ModelDescription],
    where: str,
) -> dict[str, Any]:
    """Start and stop time, step and algorithm (s), as far as `given` does not state them."""
    stated = structure.experiment
    found: dict[str, Any] = {"start_time": 0.0}
    if stated is not None and stated.start_time is not None:
        found["start_time"] = stated.start_time
    if stated is not None and stated.stop_time is not None:
        found["stop_time"] = stated.stop_time
    else:
        found["stop_time"] = found["start_time"] + _length(fmus, where)
    if "step" not in given:
        found["step"] = _step(structure, found, fmus, where)
    if "algorithm" not in given and len(fmus) > 1:
        found["algorithm"] = "jacobi"
        warn(f"{where} states no algorithm: Jacobi (--set algorithm=gauss-seidel)", stacklevel=2)
    return found


def own_steps(step: float, fmus: Mapping[str, ModelDescription], where: str) -> dict[str, float]:
    """Steps of FMUs that cannot take the common `step`, their internal one being no divisor."""
    found = {}
    for name, description in fmus.items():
        fixed = _fixed(description)
        if fixed and nearest_nanosecond(step) % nearest_nanosecond(fixed):
            found[name] = _rounded(fixed)
            why = f"steps by {found[name]!r} s, its fixed internal step"
            warn(f"{where}: {name} {why}", stacklevel=2)
    return found


def _length(fmus: Mapping[str, ModelDescription], where: str) -> float:
    lengths = [
        d.stop_time - (d.start_time or 0.0) for d in fmus.values() if d.stop_time is not None
    ]
    legal = [one for one in lengths if 0.0 < one < float("inf")]
    length = max(legal, default=_LENGTH)
    origin = "the longest default experiment of its FMUs" if legal else "for want of any statement"
    warn(f"{where} states no stop time: {length!r} s are run, {origin} (--set stop_time=…)",
         stacklevel=2)  # fmt: skip
    return length


def _step(
    structure: SystemStructure,
    found: Mapping[str, Any],
    fmus: Mapping[str, ModelDescription],
    where: str,
) -> float:
    hint = fixed_step(structure)
    fixed = [f for f in map(_fixed, fmus.values()) if f]
    length = found["stop_time"] - found["start_time"]
    usual = [d.step_size for d in fmus.values() if d.step_size and d.step_size > 0.0]
    if hint is not None:
        step, origin = hint[0], f"from its annotation {hint[1]}"
    elif fixed:
        step, origin = max(fixed), "the longest fixed internal step of its FMUs"
    elif usual:
        step, origin = _dividing(min(usual), length), "the shortest default step of its FMUs"
    else:
        step = length / _STEPS
        origin = f"a {_STEPS}th of the run"
    step = _rounded(step)
    warn(f"{where} states no step: {step!r} s, {origin} (--set step=…)", stacklevel=2)
    return step


def _dividing(step: float, length: float) -> float:
    """The longest step up to `step` of which there is a whole number in the run (s)."""
    run, longest = nearest_nanosecond(length), max(nearest_nanosecond(step), 1)
    least = max(-(-run // longest), 1)
    count = next((n for n in range(least, 2 * least) if run % n == 0), None)
    return step if count is None else run / count / 1e9


def _fixed(description: ModelDescription) -> float | None:
    cs = description.co_simulation
    step = None if cs is None else cs.fixed_internal_step_size
    return step if step and nearest_nanosecond(step) > 0 else None


def _rounded(step: float) -> float:
    return max(nearest_nanosecond(step), 1) / 1e9
