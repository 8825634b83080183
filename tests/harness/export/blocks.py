"""Blocks to export: the registered controllers as experiments configure them, and small ones."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from controllers.core.block import Array, Block, Signal
from controllers.pid.pid import PID
from harness import registry
from harness.compiler.step import compile_step
from harness.experiment.experiment import Experiment
from harness.system.graph import BlockComponent

# registered name: experiment, variant, component
EXAMPLES = {
    "augmented_choosing": ("takata/figure_1", "n_3", "controller"),
    "difference": ("raheem2013/figure_10", "matched", "error"),
    "encoder_speed": ("serkies2013/figure_10", "fuzzy", "encoder"),
    "fuzzy_inertia_estimator": ("serkies2013/figure_10", "fuzzy", "inertia_estimator"),
    "fuzzy_inertia_tables": ("serkies2013/figure_3", "run", "fuzzy"),
    "fuzzy_pid": ("ahn2009/figure_7", "fuzzy_pid", "controller"),
    "gain": ("ahn2009/sensitivity", "pid", "sensor"),
    "gain_adaptation_curve": ("serkies2013/figure_5", "run", "fuzzy"),
    "identifier": ("barragan/narendra_parthasarathy", "least_squares", "identifier"),
    "kalman_bucy": ("takata/figure_3", "aaccf", "filter"),
    "lq_regulator": ("takata/figure_3", "loc", "controller"),
    "lqg_servo": ("ahn2009/figure_7", "lqg", "controller"),
    "luenberger": ("serkies2013/observers", "noisy", "fast"),
    "narendra_parthasarathy": ("barragan/narendra_parthasarathy", "linear", "plant"),
    "pid": ("ahn2009/figure_7", "pid", "controller"),
    "sectionwise_model": ("takata/figure_2", "n_3", "controller"),
    "servo_estimator": ("raheem2013/figure_10", "matched", "filter"),
    "tuned_fuzzy_pid": ("ahn2009/figure_7", "robust_ekf", "controller"),
    "two_mass_controller": ("serkies2013/figure_10", "fuzzy", "controller"),
    "two_mass_kalman": ("serkies2013/figure_10", "fuzzy", "kalman"),
}
# state_controller is a base for others and takes a model; two_mass_controller is one of its kind
WITHOUT_EXAMPLE = {"state_controller"}
LONG_TO_COMPILE = {
    "fuzzy_inertia_estimator", "fuzzy_inertia_tables", "fuzzy_pid", "gain_adaptation_curve",
    "identifier", "kalman_bucy", "servo_estimator", "tuned_fuzzy_pid", "two_mass_kalman",
}  # fmt: skip


@cache
def example(name: str) -> tuple[Block, float]:
    """The block of a registered controller, and its sample time in seconds."""
    experiment, variant, component = EXAMPLES[name]
    bench = Experiment.load(registry.experiment(experiment)).bench(variant)
    found = bench.system().component(component)
    assert isinstance(found, BlockComponent)
    assert type(bench.controllers[component]) is registry.controller(name)
    return found.block, found.period_ns / 1e9


@cache
def pid() -> Block:
    """A PID with every branch in use, sampled at 10 ms."""
    return PID(kp=1.0, ki=20.0, kd=0.1, derivative_filter=0.05, u_min=-2.0, u_max=3.0).block(0.01)


def counter_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Counts its samples and echoes what it read."""
    x[0] += p[0]
    y[0] = x[0]
    y[1] = u[0]


def counter() -> Block:
    """`count` and `echo` of `u`; `increment` is tunable, `unused` is not."""
    return Block(
        inputs=(Signal("u", "m", "input", 0.25),),
        outputs=(Signal("count", "1", "samples", -1.0), Signal("echo", "m", "u", -2.0)),
        step=counter_step,
        parameters=np.array([1.0, np.inf]),
        parameter_names=("increment", "unused"),
        state=np.zeros(1),
        state_names=("count",),
        tunable=("increment",),
    )


def random_inputs(block: Block, n: int) -> NDArray[np.float64]:
    """n rows of inputs about their start values: forces up to kilonewtons, all else about 0.1."""
    scale = [1000.0 if s.unit == "N" else 0.1 for s in block.inputs]
    draws = np.random.default_rng(3).standard_normal((n, len(scale)))
    return np.array([s.start for s in block.inputs]) + scale * draws


class InProcess:
    """A block as the loop runs it: the compiled step on arrays of its own."""

    def __init__(self, block: Block) -> None:
        self.p, self.x = block.parameters.copy(), block.state.copy()
        self.u, self.y = np.zeros(len(block.inputs)), np.zeros(len(block.outputs))
        self.compiled = compile_step(block)

    def __call__(self, inputs: NDArray[np.float64]) -> NDArray[np.float64]:
        """The outputs for these inputs."""
        self.u[:] = inputs
        self.compiled(self.p, self.x, self.u, self.y)
        return self.y
