"""How an FMU is run: every decision that the standard leaves to the importer, stated once.

The same words are flags of `simulate`, keys of a component in an experiment file, and arguments of
`Bench.fmu`.

interface_type  co-simulation where the FMU has it, else model exchange, else scheduled execution
tolerance       that of the FMU's default experiment; a solver for model exchange falls back on 1e-6
solver          of model exchange: CVODE, or an explicit method of fixed or controlled step
largest_step    of the solver (s): a 50th of the run for CVODE; the communication step for the rest
event_mode      of FMI 3 co-simulation: used where the FMU has it; early return is permitted only
                together with it, since without it nobody could handle the event
discarded_steps "divide": a step that the FMU discards is repeated in halves, where it can go back;
                "fail": it ends the run. An FMU alone divides; one of several fails, since what the
                others are given would be held for longer than the system says
allow_not_finite NaN and infinity in outputs are values like others; otherwise they end the run
validate        faults of the description end the run; without, those that let it be read are notes

An FMU that asks for the end of the simulation ends it: alone that is a complete run, in a system a
fault, since the others have not come to their stop time. Terminate is called where the last call
was no fault; what it returns then changes nothing, since all rows are there: it is a note. The stop
time is told to the FMU. FMUs of FMI 1 and 2 that return Pending are waited for, as long as a call
may last. Intermediate update is not asked for: no callback is given, and nothing that the standard
grants depends on one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

from harness.errors import UsageError
from harness.fmi.binding.interface import (
    CO_SIMULATION,
    MODEL_EXCHANGE,
    SCHEDULED_EXECUTION,
    InterfaceType,
    capabilities,
)
from harness.fmi.description.model_description import Capabilities, ModelDescription

SOLVER_TOLERANCE = 1e-6
Solver = Literal["cvode", "euler", "rk4", "dopri5"]
SOLVERS: tuple[str, ...] = get_args(Solver)
DiscardedSteps = Literal["divide", "fail"]
DISCARDED_STEPS: tuple[str, ...] = get_args(DiscardedSteps)

_KINDS: tuple[InterfaceType, ...] = (CO_SIMULATION, MODEL_EXCHANGE, SCHEDULED_EXECUTION)
_BY_NAME = {kind.replace("-", ""): kind for kind in _KINDS}
_BY_NAME |= dict(zip(("cs", "me", "se"), _KINDS, strict=True))


@dataclass(frozen=True)
class Policy:
    """What the user said of how an FMU is run; None where nothing was said (times in s)."""

    interface_type: str | None = None
    tolerance: float | None = None
    solver: str = "cvode"
    largest_step: float | None = None
    event_mode: bool | None = None
    discarded_steps: str = "fail"
    validate: bool = True
    allow_not_finite: bool = False


def interface(name: str | None, d: ModelDescription) -> InterfaceType:
    """The kind of interface to use: the one that was asked for, else the first that the FMU has.

    Raises `UsageError` for an unknown kind and `FmuError` where the FMU lacks it.
    """
    if name is not None:
        kind = _BY_NAME.get(name.lower().replace("-", "").replace("_", "").replace(" ", ""))
        if kind is None:
            raise UsageError(
                f"interface type {name!r} is unknown; choose co-simulation, model-exchange or "
                "scheduled-execution"
            )
    elif d.co_simulation is not None:
        kind = CO_SIMULATION
    elif d.model_exchange is not None:
        kind = MODEL_EXCHANGE
    else:
        kind = SCHEDULED_EXECUTION if d.scheduled_execution else CO_SIMULATION
    capabilities(d, kind)
    return kind


def capabilities_of(policy: Policy, d: ModelDescription) -> Capabilities:
    """What an FMU can do in the kind of interface with which it is run; in model exchange one that
    remembers its states only returns to them without a function of its own."""
    kind = interface(policy.interface_type, d)
    found = capabilities(d, kind)
    if kind == MODEL_EXCHANGE and remembers_states_only(d):
        return replace(found, can_get_and_set_fmu_state=True)
    return found


def remembers_states_only(d: ModelDescription) -> bool:
    """Whether continuous states and time are all that an FMU in model exchange can remember: it
    declares no event indicators, and nothing discrete but what it is given."""
    given = ("input", "parameter", "structuralParameter")
    discrete = (v for v in d.variables.values() if v.variability == "discrete")
    indicators = d.number_of_event_indicators or d.event_indicators
    return not indicators and all(v.causality in given for v in discrete)


def tolerance_of(policy: Policy, d: ModelDescription) -> float | None:
    """The relative tolerance that is offered to an FMU or its solver, or None."""
    return d.tolerance if policy.tolerance is None else policy.tolerance
