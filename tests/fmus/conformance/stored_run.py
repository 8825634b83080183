"""A run that is stored in the middle, and its second half; also as a process of its own.

    python -m tests.fmus.conformance.stored_run FMU store FOLDER
    python -m tests.fmus.conformance.stored_run FMU restore FOLDER

`store` writes the serialized state to FOLDER/state and the second half's values to FOLDER/first;
`restore` starts from the bytes in a new instance and writes FOLDER/second.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from fmpy import read_model_description
from numpy.typing import NDArray

from tests.fmus.packaging.instances import Instance, load

STEP = 2.0**-7
HALF = 24


def signals(fmu: Path) -> tuple[list[tuple[str, float]], list[str]]:
    """Inputs with their nominal values, and everything that a step can change."""
    variables = read_model_description(str(fmu)).modelVariables
    inputs = [(v.name, float(v.nominal or 1.0)) for v in variables if v.causality == "input"]
    return inputs, [v.name for v in variables if v.causality in ("output", "local")]


def drive(instance: Instance, fmu: Path, first: int, n: int) -> NDArray[np.float64]:
    """Step from step number `first` on under sines; values after each step."""
    inputs, names = signals(fmu)
    rows = []
    for k in range(first, first + n):
        t = k * STEP
        instance.set(**{v: 0.3 * c * np.sin(20 * t + i) for i, (v, c) in enumerate(inputs)})
        instance.step(k, STEP)
        rows.append(instance.get(*names))
    return np.array(rows)


def started(fmu: Path, folder: Path) -> Instance:
    """An instance ready to step."""
    instance = load(fmu, folder)
    instance.instantiate()
    instance.initialize()
    return instance


def serialized(instance: Instance) -> bytes:
    """The state as bytes."""
    state = instance.fmu.getFMUState()
    data: bytes = instance.fmu.serializeFMUState(state)
    instance.fmu.freeFMUState(state)
    return data


def restore(instance: Instance, data: bytes) -> None:
    """Continue from the bytes."""
    state = instance.fmu.deserializeFMUState(data)
    instance.fmu.setFMUState(state)
    instance.fmu.freeFMUState(state)


def main(fmu: Path, task: str, folder: Path) -> None:
    """One of the two tasks."""
    with TemporaryDirectory() as unpacked:
        instance = started(fmu, Path(unpacked))
        if task == "store":
            drive(instance, fmu, 0, HALF)
            (folder / "state").write_bytes(serialized(instance))
            np.save(folder / "first.npy", drive(instance, fmu, HALF, HALF))
        else:
            restore(instance, (folder / "state").read_bytes())
            np.save(folder / "second.npy", drive(instance, fmu, HALF, HALF))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
