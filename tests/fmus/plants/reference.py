"""Reference trajectories of the plants: Radau with rtol 1e-10 over held inputs.

    python -m tests.fmus.plants.reference         writes fmus/<plant>/reference.csv

Row k holds time k·0.01 s, the inputs that are applied from then on until the next row, and the
states and outputs at that time under those inputs. Columns are named as in the plant.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from math import cos, pi, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import fmus
from fmus.plant import Plant
from tests.fmus.plants.bench import (
    Simulator,
    disturbance_generator,
    electro_hydraulic_servo,
    hybrid_actuator,
    oscillator_left,
    oscillator_right,
    single_machine_infinite_bus,
    two_mass_drive,
)

STOP_TIME = 0.4
RTOL = 1e-10


def hybrid_inputs(t: float) -> tuple[float, ...]:
    """A step of the command, then a sine that pulls the spring; the environment moves ±1 mm."""
    command = 0.0 if t < 0.02 else 0.15 if t < 0.2 else 0.25 * cos(2 * pi * 2.5 * (t - 0.1))
    pace = 2 * pi * 4
    return command, 1e-3 * sin(pace * t), 1e-3 * pace * cos(pace * t)


def generator_inputs(t: float) -> tuple[float, ...]:
    """A sine of the command against a spring force that swings between 0 and 3 kN."""
    command = 0.3 * sin(2 * pi * 3 * t) + (0.2 if t >= 0.3 else 0.0)
    return command, 1500.0 * (1 - cos(2 * pi * 2 * t))


def servo_inputs(t: float) -> tuple[float, ...]:
    """1 mA, then a reversal, with a current error and an outside force that swing."""
    current = 1e-3 if t < 0.2 else -2e-3
    return current, 1e-4 * sin(2 * pi * 7 * t), 100.0 * sin(2 * pi * 3 * t)


def machine_inputs(t: float) -> tuple[float, ...]:
    """A pulse of the field that starts a swing, then a sine; a step of power."""
    field = 0.8 if t < 0.2 else 0.3 * sin(2 * pi * 1.5 * t)
    return field, 0.1 if t >= 0.25 else 0.0


def drive_inputs(t: float) -> tuple[float, ...]:
    """Start beyond the torque limit, a load step, a flywheel that is coupled at 0.25 s."""
    torque = 3.5 if t < 0.1 else 0.6 * cos(2 * pi * 8 * t)
    return torque, 0.5 if t >= 0.15 else 0.0, 0.203 if t < 0.25 else 0.406


def left_inputs(t: float) -> tuple[float, ...]:
    """A pulse of the force, then a swing near resonance."""
    return (20.0 if t < 0.1 else 5.0 * sin(10 * t),)


def right_inputs(t: float) -> tuple[float, ...]:
    """The left mass is pulled aside, then swings."""
    return (0.05, 0.0) if t < 0.1 else (0.1 * sin(10 * t), cos(10 * t))


CASES: tuple[tuple[Plant, Callable[[float], tuple[float, ...]]], ...] = (
    (hybrid_actuator, hybrid_inputs),
    (disturbance_generator, generator_inputs),
    (electro_hydraulic_servo, servo_inputs),
    (single_machine_infinite_bus, machine_inputs),
    (two_mass_drive, drive_inputs),
    (oscillator_left, left_inputs),
    (oscillator_right, right_inputs),
)


def path(plant: Plant) -> Path:
    """Where the trajectory of a plant lies."""
    return Path(fmus.__file__).parent / plant.name / "reference.csv"


def header(plant: Plant) -> list[str]:
    """Column names."""
    return ["time", *(v.name for v in (*plant.inputs, *plant.states, *plant.outputs))]


def trajectory(
    plant: Plant, inputs: Callable[[float], tuple[float, ...]], rtol: float = RTOL
) -> NDArray[np.float64]:
    """Rows of the reference file, shape (N + 1, columns)."""
    run = Simulator(plant).run(inputs, STOP_TIME, rtol)
    return np.column_stack([run.time, run.u, run.x, run.y])


def read(plant: Plant) -> tuple[list[str], NDArray[np.float64]]:
    """Header and rows of the file."""
    with path(plant).open(newline="") as file:
        names, *rows = csv.reader(file)
    return names, np.array(rows, dtype=float)


def main() -> None:
    """Write the files."""
    for plant, inputs in CASES:
        with path(plant).open("w") as file:
            file.write(",".join(f'"{name}"' for name in header(plant)) + "\n")
            for row in trajectory(plant, inputs):
                file.write(",".join(format(value, ".17g") for value in row) + "\n")


if __name__ == "__main__":
    main()
