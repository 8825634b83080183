"""The lead experiment of Ahn 2009 as a package for other tools, and as our loop with a delay."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness import registry
from harness.experiment.experiment import Experiment
from harness.experiment.merging import merge
from harness.ssp.from_experiment import export_experiment
from tests.peers.order import Order, run_in

Rows = NDArray[np.float64]

EXPERIMENT = "ahn2009/figure_9"
SIGNALS = ("reference.value", "controller.u", "plant.force", "plant.position")
COMPUTED_BEFORE = {"controller.u"}
"""What another tool shows after the step from t_k is our row at t_k+1, but of a controller's FMU
what it computed at t_k."""


def experiment(
    version: int, stop_time: float, *, delay: float = 0.0, **settings: Any
) -> Experiment:
    """Without the disturbance and noise, which other tools do not see; `delay` (s) is that of the
    wire from the controller to the plant."""
    changes = {
        "fmi_version": version,
        "stop_time": stop_time,
        "connections": {
            "controller.measured": {"from": "plant.force", "imperfections": []},
            "plant.command": {"from": "controller.u", "delay": delay},
        },
    }
    return Experiment.load(registry.experiment(EXPERIMENT), merge(changes, settings))


def exported(one: Experiment, variant: str, folder: Path) -> Path:
    target = folder / f"{variant}.ssp"
    export_experiment(one, target, [variant])
    return target


def ours(one: Experiment, variant: str) -> Rows:
    """Our rows in the order in which another tool shows `SIGNALS` after each step."""
    result = one.run(variant)
    columns = [result[s][:-1] if s in COMPUTED_BEFORE else result[s][1:] for s in SIGNALS]
    return np.array(columns).T


def theirs(tool: str, package: Path, step: float, steps: int) -> Rows:
    """The same rows under another tool."""
    order = Order(fmus={}, step=step, steps=steps, outputs=list(SIGNALS), package=str(package))
    return run_in(tool, order)
