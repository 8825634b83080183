"""A signal as a block, so that it can become an FMU: the samples of a run, one after the other.

An FMU shows what it computed in the step that begins at t_k when that step is over, at t_{k+1}.
The block therefore gives sample k + 1 at instant k, and starts with sample 0: a tool that passes
values on between steps hands every reader the sample of its own instant.

Refused are signals with more than `MAX_EDGES` changes: each takes two numbers in the FMU.
"""

from __future__ import annotations

import numpy as np

from harness.clock import show
from harness.errors import ExperimentError
from harness.instruments.source import named_seed
from harness.system.block import Array, KernelBlock, Port
from harness.system.graph import SignalComponent, System

MAX_EDGES = 20_000


def sequence_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = the last p[2 j + 1] with p[2 j] <= x[0] + 1; x = (instant, j)."""
    j = int(x[1])
    while 2 * (j + 1) < p.shape[0] and p[2 * (j + 1)] <= x[0] + 1.0:
        j += 1
    y[0] = p[2 * j + 1]
    x[0] += 1.0
    x[1] = float(j)


def sequence_block(component: SignalComponent, system: System, unit: str = "") -> KernelBlock:
    """The block of a signal over the run of its system, whose random numbers it repeats.

    `unit` is that of its readers, for a signal that states none. Raises `ExperimentError`.
    """
    if component.phase_ns:
        raise ExperimentError(
            f"component {component.name} starts at {show(component.phase_ns)}; a signal with a "
            "phase cannot become an FMU; leave its phase out"
        )
    count = (system.stop_ns - system.start_ns) // component.period_ns + 1
    instants = system.start_ns + component.period_ns * np.arange(count, dtype=np.int64)
    sampler = component.source.sampler(named_seed(system.seed, component.name))
    values = np.asarray(sampler.sample(instants), dtype=np.float64)
    edges = np.flatnonzero(np.concatenate([[True], values[1:] != values[:-1]]))
    if len(edges) > MAX_EDGES:
        raise ExperimentError(
            f"component {component.name} changes {len(edges)} times in the run; at most "
            f"{MAX_EDGES} fit an FMU: sample it more coarsely (its key step) or stop earlier"
        )
    table = np.column_stack([edges.astype(np.float64), values[edges]]).ravel()
    name = component.outputs[0].unit or unit
    return KernelBlock(
        inputs=(),
        outputs=(Port("value", name, "the signal, held between its samples", float(values[0])),),
        step=sequence_step,
        parameters=table,
        state=np.zeros(2),
    )
