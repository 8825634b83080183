"""One run of a plant by the harness, with a step and three sines on each input.

The communication step is 2^-7 s, which a float and a whole number of nanoseconds both hold
exactly; so no importer can step otherwise by rounding, and agreement can be to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi, sin

import numpy as np
from numpy.typing import NDArray

from fmus.declaration import Variable
from fmus.plant import Plant
from harness.bench import Bench
from harness.results.result import Result

Array = NDArray[np.float64]
Signal = Callable[[Plant, int, float], float]

STEP = 2.0**-7
STOP_TIME = 64 * STEP
FREQUENCIES = (1.0, 3.7, 11.0)


@dataclass(frozen=True)
class Excited:
    """Rows at k·step: `inputs` as held from row k on, `states` at row k, both (rows, columns)."""

    plant: Plant
    step: float
    inputs: Array
    states: Array
    result: Result


def excitation(plant: Plant, number: int, time: float) -> float:
    """Value of input `number`: a fifth of its nominal from 0.05 s on, and sines of a tenth."""
    variable = plant.inputs[number]
    waves = sum(sin(2 * pi * f * time + 2.0 * number + f) for f in FREQUENCIES)
    step = 0.2 if time >= 0.05 else 0.0
    return variable.start + variable.nominal * (step + 0.1 * waves)


def forth_and_back(plant: Plant, number: int, time: float) -> float:
    """The first input rests, steps by a tenth of its nominal, steps back, and is released."""
    variable = plant.inputs[number]
    share = 0.0 if time < 0.03 or time >= 0.33 else 0.1 if time < 0.18 else -0.1
    return variable.start + (share * variable.nominal if number == 0 else 0.0)


def driven(
    plant: Plant, version: int, tolerance: float | None = None, signal: Signal = excitation
) -> Bench:
    """A bench on which every input of the plant, called "plant", follows `signal`."""
    bench = Bench(stop_time=STOP_TIME, step=STEP, fmi_version=version)
    bench.fmu("plant", plant.fmu(version), tolerance=tolerance)
    for number, variable in enumerate(plant.inputs):
        _drive(bench, plant, number, variable, signal)
    bench.record = ("plant.*", *(f"plant.{state.name}" for state in plant.states))
    return bench


def _drive(bench: Bench, plant: Plant, number: int, variable: Variable, signal: Signal) -> None:
    source = f"signal_{variable.name}"
    bench.signal(source, "function", function=lambda t: signal(plant, number, t))
    bench.connect(source, f"plant.{variable.name}")


def excite(
    plant: Plant, version: int, tolerance: float | None = None, signal: Signal = excitation
) -> Excited:
    """Run the excited plant."""
    result = driven(plant, version, tolerance, signal).run()
    return Excited(plant, STEP, *held_rows(plant, result, "plant"), result)


def held_rows(plant: Plant, result: Result, component: str) -> tuple[Array, Array]:
    """Inputs and states of a component from a result, (rows, n_u) and (rows, n_x)."""
    rows = len(result.time)
    inputs = [result[f"{component}.{variable.name}"] for variable in plant.inputs]
    states = [result[f"{component}.{state.name}"] for state in plant.states]
    return np.array(inputs).T.reshape(rows, -1), np.array(states).T.reshape(rows, -1)


def held_signals(plant: Plant, run: Excited) -> Array:
    """The inputs as FMPy takes them: a structured array with two entries at each instant, so that
    they jump there and are constant in between."""
    fields = [("time", float), *((v.name, float) for v in plant.inputs)]
    rows: list[tuple[float, ...]] = []
    for k, values in enumerate(run.inputs):
        before = run.inputs[max(k - 1, 0)]
        rows += [(k * run.step, *before)] if k else []
        rows.append((k * run.step, *values))
    return np.array(rows, dtype=fields)
