"""Who makes FMUs of controllers: the part of the harness that exports them, if it is there."""

from __future__ import annotations

import importlib
from pathlib import Path

from harness.errors import ExperimentError
from harness.system.block import Block

_MAKER = "harness.export.controller"


def block_fmu(
    block: Block, name: str, sample_time: float, fmi_version: int = 3, *, phase: float = 0.0
) -> Path:
    """The FMU of a block, which needs no Python; raises `HarnessError`."""
    try:
        maker = importlib.import_module(_MAKER)
    except ModuleNotFoundError as fault:
        raise ExperimentError(
            f"component {name} needs an FMU of its own, and this installation cannot make FMUs of "
            "controllers and signals"
        ) from fault
    made: Path = maker.controller_fmu(block, name, sample_time, fmi_version, phase=phase)
    return made
