"""The kinds of participant, by what they stand for in a system."""

from __future__ import annotations

from harness.participants import cosimulation as cosimulation
from harness.participants import model_exchange as model_exchange
from harness.participants import scheduled_execution as scheduled_execution
from harness.participants.block import BlockParticipant
from harness.participants.events import settle_entry
from harness.participants.model_exchange.equations import callbacks
from harness.participants.model_exchange.kernels import entries
from harness.participants.participant import Participant
from harness.participants.python import PythonParticipant
from harness.participants.sensitivity import SensitivityParticipant
from harness.participants.signal import SignalParticipant
from harness.system.graph import (
    BlockComponent,
    PythonComponent,
    SampledComponent,
    SensitivityComponent,
    SignalComponent,
)


def sampled(component: SampledComponent) -> Participant:
    """The participant for what is no FMU; raises `CompileError` for a block that cannot be
    compiled."""
    match component:
        case BlockComponent():
            return BlockParticipant(component)
        case PythonComponent():
            return PythonParticipant(component)
        case SignalComponent():
            return SignalParticipant(component)
        case SensitivityComponent():
            return SensitivityParticipant(component)


def load_kernels(*, exchange: bool) -> None:
    """Compile, or fetch, the code that participants with events call, also that of model exchange;
    where processes are forked it is best there before."""
    settle_entry()
    if exchange:
        callbacks()
        entries()
