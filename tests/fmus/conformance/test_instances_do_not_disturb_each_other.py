"""Instances of one loaded library, interleaved or in threads, run as each would alone."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fmus.plant import Plant
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.fmu import Fmu
from tests.fmus.conformance.excitation import STEP, excitation

Array = NDArray[np.float64]
STEPS = 32


def started(opened: Fmu, name: str, tolerance: float | None = None) -> FmuInstance:
    instance = opened.instantiate(name)
    instance.enter_initialization_mode(0.0, None, tolerance)
    instance.exit_initialization_mode()
    return instance


def step(instance: FmuInstance, plant: Plant, k: int, gain: float) -> list[float]:
    """One step with the plant's excitation times `gain`; all states and outputs after it."""
    for number, variable in enumerate(plant.inputs):
        instance.set({variable.name: gain * excitation(plant, number, k * STEP)})
    instance.do_step(k * STEP, STEP)
    return [instance.get(v.name) for v in (*plant.states, *plant.outputs)]


def run(instance: FmuInstance, plant: Plant, gain: float) -> Array:
    return np.array([step(instance, plant, k, gain) for k in range(STEPS)])


def test_interleaved(plant: Plant, fmu: Path) -> None:
    """The others have another tolerance, other inputs, and one is freed half way."""
    with Fmu(fmu) as opened, started(opened, "alone") as alone:
        expected = run(alone, plant, 1.0)
        with started(opened, "one") as one, started(opened, "two", 1e-3) as two:
            three, rows = started(opened, "three"), []
            for k in range(STEPS):
                step(two, plant, k, -1.0)
                rows.append(step(one, plant, k, 1.0))
                if k < STEPS // 2:
                    step(three, plant, k, 0.5)
                elif k == STEPS // 2:
                    three.free()
        assert np.array_equal(rows, expected)


def test_in_threads(plant: Plant, fmu: Path) -> None:
    """Eight at once; the calls into the library release the interpreter's lock."""
    gains = [1.0, -1.0, 0.5, -0.5] * 2
    with Fmu(fmu) as opened:
        instances = [started(opened, f"instance {i}") for i in range(16)]
        alone = [run(i, plant, gain) for i, gain in zip(instances[:8], gains, strict=True)]
        with ThreadPoolExecutor(8) as pool:
            together = list(pool.map(run, instances[8:], [plant] * 8, gains))
        for instance in instances:
            instance.free()
    assert np.array_equal(alone, together)


def test_two_plants_side_by_side(plant: Plant, fmu: Path, version: int) -> None:
    """The same plant from two archives: two libraries of the same name in one process."""
    with Fmu(fmu) as first, Fmu(fmu) as second:
        with started(first, "a") as a, started(second, "b") as b:
            rows = [(step(a, plant, k, 1.0), step(b, plant, k, -1.0)) for k in range(STEPS)]
        with started(first, "c") as c, started(second, "d") as d:
            expected = run(c, plant, 1.0), run(d, plant, -1.0)
    assert np.array_equal([row[0] for row in rows], expected[0])
    assert np.array_equal([row[1] for row in rows], expected[1])
