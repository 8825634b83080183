"""Makes parity certificates: the in-process object and its FMU, side by side on the same inputs.

The inputs are sines whose amplitude grows from row to row, so that small and large values of
variables of unknown size are met; the run ends before the first row that is not finite.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import sin
from pathlib import Path
from typing import Protocol

import numpy as np

from harness.errors import FmuError
from harness.export.certificate import Certificate
from harness.export.verify import Array, compare, replay
from harness.fmi.binding.library import library_path
from harness.fmi.fmu import Fmu
from harness.results.manifest import software_versions
from harness.system.block import Block

ROWS = 60
TRIAL_STEPS = 5
PLANT_TOLERANCE = 1e-6
"""Of an output's range: a solver with step size control may take another number of steps."""
BLOCK_TOLERANCE = 1e-9
_SMALLEST, _DECADES = 1e-2, 5
_SOFTWARE = ("python", "fmu-harness", "numpy", "numba", "llvmlite", "casadi", "pythonfmu")

Columns = Mapping[str, tuple[float, ...]]


class PlantReference(Protocol):
    """A plant stepped in this process."""

    @property
    def inputs(self) -> Sequence[str]:
        """Names in the order of `step`'s inputs."""

    @property
    def outputs(self) -> Sequence[str]:
        """Names in the order of `step`'s result."""

    def step(self, inputs: Sequence[float], length: float) -> Sequence[float]:
        """Hold `inputs`, step by `length` (s), return the outputs."""


def plant_certificate(
    path: Path, reference: PlantReference, scales: Mapping[str, tuple[float, float]], step: float
) -> Certificate:
    """The certificate of a plant's FMU; `scales` holds start and nominal of each input.

    Raises `FmuError` when the FMU cannot be run or does not agree within `PLANT_TOLERANCE`.
    """
    inputs = {
        name: tuple(scales[name][0] + 0.2 * scales[name][1] * sin(0.37 * (i + 1) * k)
                    for k in range(ROWS))
        for i, name in enumerate(reference.inputs)
    }  # fmt: skip
    rows = [
        list(reference.step([column[k] for column in inputs.values()], step)) for k in range(ROWS)
    ]
    outputs = _columns(tuple(reference.outputs), np.array(rows))
    said = "the plant's equations and solver in Python"
    return _certified(path, said, step, inputs, outputs, PLANT_TOLERANCE)


def block_certificate(path: Path, block: Block, sample_time: float) -> Certificate:
    """The certificate of a block's FMU, against its step function as plain Python.

    Raises `FmuError` when the FMU cannot be run or does not agree within `BLOCK_TOLERANCE`.
    """
    inputs = growing([signal.name for signal in block.inputs])
    p, x = block.parameters.copy(), block.state.copy()
    u, y = np.zeros(len(block.inputs)), np.zeros(len(block.outputs))
    rows: list[Array] = []
    with np.errstate(all="ignore"):
        for k in range(ROWS):
            u[:] = [column[k] for column in inputs.values()]
            block.step(p, x, u, y)
            if not (np.isfinite(y).all() and np.isfinite(x).all()):
                break
            rows.append(y.copy())
    if not rows:
        raise FmuError(f"the block of {path.name} gives no finite outputs on any test input")
    inputs = {name: column[: len(rows)] for name, column in inputs.items()}
    outputs = _columns(tuple(signal.name for signal in block.outputs), np.array(rows))
    said = "the block's step function in Python"
    return _certified(path, said, sample_time, inputs, outputs, BLOCK_TOLERANCE)


def growing(names: Sequence[str]) -> dict[str, tuple[float, ...]]:
    """A sine of its own for each name, from a hundredth to a thousand over `ROWS` rows."""
    sizes = [_SMALLEST * 10 ** (_DECADES * k / (ROWS - 1)) for k in range(ROWS)]
    return {
        name: tuple(sizes[k] * sin(0.9 * k + 1.3 * i + 0.5) for k in range(ROWS))
        for i, name in enumerate(names)
    }


def _columns(names: Sequence[str], rows: Array) -> dict[str, tuple[float, ...]]:
    return {name: tuple(map(float, rows[:, i])) for i, name in enumerate(names)}


def _certified(
    path: Path, reference: str, step: float, inputs: Columns, outputs: Columns, tolerance: float
) -> Certificate:
    draft = Certificate(path.stem, reference, step, inputs, outputs, {}, tolerance, made_with())
    if not _runs_here(path):
        return draft
    _run_with_nothing_set(path, step)
    found = compare(path, draft)
    if found.off:
        worst = found.off[0]
        raise FmuError(
            f"FMU {path.name} differs from {reference} by {found.difference[worst]:.3g} in output "
            f"{worst!r} (at most {found.allowed[worst]:.3g} is allowed), so it is not certified"
        )
    return replace(draft, difference=found.difference)


def _run_with_nothing_set(path: Path, step: float) -> None:
    """Raise `FmuError` where the FMU does not run from its own start values, as importers begin."""
    try:
        replay(path, step, TRIAL_STEPS, {}, ())
    except FmuError as fault:
        raise FmuError(
            f"FMU {path.name} does not run from its own start values: {fault}; give its inputs, "
            "states and parameters start values that its equations can be computed with"
        ) from fault


def _runs_here(path: Path) -> bool:
    """Whether the FMU has a library for this platform; one made for others is replayed there."""
    with Fmu(path) as fmu:
        d = fmu.description
        try:
            return d.co_simulation is not None and bool(
                library_path(fmu.folder, d.co_simulation.model_identifier, d.fmi_major)
            )
        except FmuError:
            return False


def made_with() -> dict[str, str]:
    """Platform and versions, without anything that names a machine."""
    return {
        "platform": f"{platform.system()} {platform.machine()}",
        "libc": " ".join(platform.libc_ver()).strip() or "unknown",
        **{name: version for name, version in software_versions().items() if name in _SOFTWARE},
    }
