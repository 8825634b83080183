"""The kinds of interface of an FMU, and what its functions report: steps and discrete states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.errors import FmuError
from harness.fmi.description.model_description import Capabilities, ModelDescription

InterfaceType = Literal["co-simulation", "model-exchange", "scheduled-execution"]
CO_SIMULATION: InterfaceType = "co-simulation"
MODEL_EXCHANGE: InterfaceType = "model-exchange"
SCHEDULED_EXECUTION: InterfaceType = "scheduled-execution"


@dataclass(frozen=True)
class StepOutcome:
    """How a communication step ended: the time (s) up to which it was computed, whether the FMU
    asks for event handling or for the end of the simulation, and whether it gave the step up."""

    time: float
    event_needed: bool = False
    terminate: bool = False
    discarded: bool = False


@dataclass(frozen=True)
class DiscreteStates:
    """What an FMU says after one iteration of event handling; `next_event_time` in s."""

    needs_update: bool
    terminate: bool = False
    nominals_changed: bool = False
    values_changed: bool = False
    next_event_time: float | None = None


def offered(d: ModelDescription) -> dict[InterfaceType, Capabilities]:
    """The kinds of interface that an FMU has, and what it can do in each."""
    kinds = {
        CO_SIMULATION: d.co_simulation, MODEL_EXCHANGE: d.model_exchange,
        SCHEDULED_EXECUTION: d.scheduled_execution,
    }  # fmt: skip
    return {kind: one for kind, one in kinds.items() if one is not None}


def capabilities(d: ModelDescription, kind: InterfaceType) -> Capabilities:
    """What the FMU can do in this kind of interface; raises `FmuError` where it lacks it."""
    found = offered(d)
    if kind not in found:
        raise FmuError(
            f"FMU {d.name} offers no {kind}; it offers {' and '.join(found) or 'nothing'}"
        )
    return found[kind]
