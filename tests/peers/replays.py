"""Parity certificates replayed in other tools: the inputs and outputs that our FMUs carry."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness import registry
from harness.clock import to_seconds
from harness.experiment.experiment import Experiment
from harness.export.certificate import read_certificate
from harness.export.controller import controller_fmu
from harness.export.plant import certified_plant_fmu
from harness.fmi.fmu import Fmu
from harness.ssp.sequence import sequence_block
from harness.system.graph import SignalComponent
from tests.harness.export.blocks import EXAMPLES, example
from tests.peers.order import Order, run_in

Array = NDArray[np.float64]


def plants(version: int, portable: bool) -> Iterator[Path]:
    """Every registered plant."""
    for name in registry.names(registry.PLANTS):
        yield certified_plant_fmu(name, version, portable=portable)


def controllers(version: int, portable: bool) -> Iterator[Path]:
    """Every registered controller and estimator, as an experiment configures it."""
    for name in EXAMPLES:
        block, sample_time = example(name)
        yield controller_fmu(block, name, sample_time, version, portable=portable)


def signals(version: int, portable: bool) -> Iterator[Path]:
    """Those of an experiment, as its package holds them."""
    system = Experiment.load(registry.experiment("ahn2009/figure_9")).bench("pid").system()
    for one in system.components:
        if isinstance(one, SignalComponent):
            block, sample_time = sequence_block(one, system), to_seconds(one.period_ns)
            yield controller_fmu(block, one.name, sample_time, version, portable=portable)


def replayed(tool: str, path: Path) -> float:
    """The largest difference between what the FMU gives under a tool and what its certificate
    holds beyond what it says of the machine that made it, relative to an output's largest value."""
    with Fmu(path) as fmu:
        made = read_certificate(fmu)
    order = Order(
        fmus={"it": str(path)},
        step=made.step,
        steps=made.rows,
        outputs=[f"it.{name}" for name in made.outputs],
        inputs={f"it.{name}": list(column) for name, column in made.inputs.items()},
    )
    expected = np.array(list(made.outputs.values())).T
    found = run_in(tool, order)
    largest = np.abs(expected).max(axis=0)
    return float(np.max(np.abs(found - expected) / np.where(largest > 0, largest, 1.0)))
