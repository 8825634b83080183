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


def capabilities(description: ModelDescription, interface_type: InterfaceType) -> Capabilities:
    """What the FMU can do in this kind of interface; raises `FmuError` where it lacks it."""
    kinds = {
        CO_SIMULATION: description.co_simulation, MODEL_EXCHANGE: description.model_exchange,
        SCHEDULED_EXECUTION: description.scheduled_execution,
    }  # fmt: skip
    found = kinds[interface_type]
    if found is None:
        offered = [kind for kind, one in kinds.items() if one is not None]
        raise FmuError(
            f"FMU {description.name} offers no {interface_type}; it offers "
            + (" and ".join(offered) or "nothing")
        )
    return found
