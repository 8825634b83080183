"""All checks by the name that the page shows, in its order, for each kind of interface."""

from __future__ import annotations

from collections.abc import Callable

from harness.fmi.binding.interface import CO_SIMULATION, MODEL_EXCHANGE, InterfaceType
from harness.inspection import checks, continuous, derivatives, snapshots
from harness.inspection.checks import CYCLES
from harness.inspection.finding import Finding
from harness.inspection.subject import Subject

Check = Callable[[Subject], Finding]

RUNS = "runs"
TWICE = "instantiates twice"
REPEATS = "repeats a run"
REPEATS_ELSEWHERE = "repeats in a new process"
RESETS = "resets"
RESTORES = "restores a snapshot"
SERIALISES = "serialises its state"
CONTINUES_ELSEWHERE = "continues in a new process"
OTHER_STEPS = "takes other steps"
INTERPOLATES = "takes slopes of inputs"
FEEDTHROUGH = "feedthrough as declared"
DERIVATIVES = "derivatives"
ROUND_TRIP = "returns its states"
NOMINALS = "nominal values"
INDICATORS = "event indicators"
SURVIVES = f"survives {CYCLES} instances"

_COMMON: dict[str, Check] = {
    RUNS: checks.runs,
    TWICE: checks.instantiates_twice,
    REPEATS: checks.repeats,
    RESETS: checks.resets,
    RESTORES: snapshots.restores,
    SERIALISES: snapshots.serialises,
    FEEDTHROUGH: derivatives.feeds_through_as_declared,
    DERIVATIVES: derivatives.differentiates,
}

_LAST: dict[str, Check] = {SURVIVES: checks.frees}

CHECKS: dict[InterfaceType, dict[str, Check]] = {
    CO_SIMULATION: _COMMON
    | {OTHER_STEPS: checks.takes_other_steps, INTERPOLATES: checks.interpolates_inputs}
    | _LAST,
    MODEL_EXCHANGE: _COMMON
    | {
        ROUND_TRIP: continuous.returns_states,
        NOMINALS: continuous.has_positive_nominals,
        INDICATORS: continuous.has_finite_indicators,
    }
    | _LAST,
}
"""By kind of interface and name, in the order of the page."""

ELSEWHERE: dict[str, Check] = {
    REPEATS_ELSEWHERE: checks.repeats,
    CONTINUES_ELSEWHERE: snapshots.continues,
}
"""Checks for a process of their own, which compare with what the first one has left."""
