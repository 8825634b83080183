"""Each plant in closed loop at 10 ms: inputs that jump at every sample, and the exact states.

A PI controller with noise on its command drives the first input; the other inputs stay at their
start. The loop runs once, with our solver at 1e-10; what it applied is then the input of every
solver, so that all solve the same problem. The reference is scipy's Radau.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.solvers import Solvers
from benchmarks.trajectory import STEP, Trajectory
from fmus.disturbance_generator.model import plant as disturbance_generator
from fmus.electro_hydraulic_servo.model import plant as electro_hydraulic_servo
from fmus.hybrid_actuator.model import plant as hybrid_actuator
from fmus.oscillator_left.model import plant as oscillator_left
from fmus.oscillator_right.model import plant as oscillator_right
from fmus.packaging.plant.functions import plant_functions
from fmus.plant import Plant
from fmus.single_machine_infinite_bus.model import plant as single_machine_infinite_bus
from fmus.two_mass_drive.model import plant as two_mass_drive

Array = NDArray[np.float64]
SEED, RTOL = 1, 1e-10


@dataclass(frozen=True)
class Loop:
    """A plant, the output that is controlled, its reference, gains (`ki` per sample), and the
    standard deviation of the noise on the command."""

    plant: Plant
    output: str
    reference: float
    kp: float
    ki: float
    noise: float


LOOPS = (
    Loop(hybrid_actuator, "force", 2000.0, 6.5e-5, 1.1e-6, 0.02),
    Loop(disturbance_generator, "position", 0.08, 10.0, 0.1, 0.1),
    Loop(electro_hydraulic_servo, "position", 0.01, 0.3, 0.0, 1e-3),
    Loop(two_mass_drive, "motor_speed", 0.5, 1.0, 0.02, 0.1),
    Loop(single_machine_infinite_bus, "speed", 0.0, -0.1, 0.0, 0.1),
    Loop(oscillator_left, "position", 0.05, 10.0, 0.1, 2.0),
    Loop(oscillator_right, "position", 0.05, 0.5, 0.01, 0.02),
)


def closed_loop(loop: Loop, solvers: Solvers, samples: int) -> Trajectory:
    """The trajectory of a loop."""
    functions, generator = plant_functions(loop.plant), np.random.default_rng(SEED)
    place = [output.name for output in loop.plant.outputs].index(loop.output)
    x, u, integral, rows = solvers.start, functions.u_start.copy(), 0.0, []
    for _ in range(samples):
        error = loop.reference - functions.h(x, u)[place]
        integral += loop.ki * error
        u = functions.u_start.copy()
        u[0] += loop.kp * error + integral + loop.noise * generator.standard_normal()
        rows.append(u)
        x = solvers.rosenbrock(5, 1e-10, STEP, u[None], x).states[-1]
    inputs = np.array(rows)
    exact = solvers.radau(RTOL, STEP, inputs).states
    return Trajectory(loop.plant, inputs, np.concatenate([solvers.start[None], exact]))
