"""The test bench: reads FMUs, plans and runs the closed loop, records, measures, draws.

    from harness import Bench, Experiment

What is offered here is imported when it is first used, so that the command line starts fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness.bench import Bench
    from harness.errors import HarnessError
    from harness.experiment.experiment import Experiment
    from harness.experiment.reopen import open_results as open
    from harness.fmi.fmu import Fmu
    from harness.results.recording import read_recording
    from harness.results.result import Result
    from harness.simulation import simulate

_PLACES = {
    "Bench": "harness.bench",
    "Experiment": "harness.experiment.experiment",
    "Fmu": "harness.fmi.fmu",
    "HarnessError": "harness.errors",
    "Result": "harness.results.result",
    "open": "harness.experiment.reopen:open_results",
    "read_recording": "harness.results.recording",
    "simulate": "harness.simulation",
}

__all__ = [
    "Bench", "Experiment", "Fmu", "HarnessError", "Result", "open", "read_recording", "simulate",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'harness' has no attribute {name!r}")
    module, _, attribute = _PLACES[name].partition(":")
    return getattr(import_module(module), attribute or name)
