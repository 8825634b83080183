"""What the reduced state vector of the lead paper's tuner saves: `python -m benchmarks.tuner_step`.

The compiled steps of both controllers of `ahn2009/state_vector` on the same inputs, less that of
the fuzzy PID, which calls and infers but does not tune: the least time of several repetitions,
since what else runs on the machine only adds to it.
"""

from __future__ import annotations

import time

import numpy as np

from harness import registry
from harness.compiler.step import compile_step
from harness.experiment.experiment import Experiment
from harness.system.graph import BlockComponent

STEPS, REPETITIONS = 2000, 15


def microseconds(variant: str) -> float:
    """Time of a step of the controller, in µs."""
    experiment = Experiment.load(registry.experiment("ahn2009/state_vector"))
    component = experiment.bench(variant).system().component("controller")
    assert isinstance(component, BlockComponent)
    block = component.block
    step = compile_step(block)
    inputs = np.random.default_rng(1).normal((2000.0, 1900.0), (0.0, 60.0), (STEPS, 2))
    least = np.inf
    for _ in range(REPETITIONS):
        state, outputs = block.state.copy(), np.zeros(len(block.outputs))
        begin = time.perf_counter()
        for row in inputs:
            step(block.parameters, state, row, outputs)
        least = min(least, time.perf_counter() - begin)
    return 1e6 * least / STEPS


def main() -> None:
    """Print both times."""
    plain, reduced, full = map(microseconds, ("fuzzy_pid", "robust_ekf", "full"))
    reduced, full = reduced - plain, full - plain
    print(f"tuning with the reduced vector of 12: {reduced:.1f} µs a step")
    print(
        f"tuning with the full vector of 35: {full:.1f} µs a step, {full / reduced:.1f} times that"
    )


if __name__ == "__main__":
    main()
