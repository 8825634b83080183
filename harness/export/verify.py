"""Replays the parity certificate of an FMU on this machine, in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.export.certificate import Certificate, read_certificate
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.process.limits import Limits
from harness.process.task import Teller, run_task

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Replay:
    """The largest absolute difference of each output here to the certificate's (`difference`, 0
    for equal bits), and what is `allowed`: `tolerance` of the range that it runs through."""

    certificate: Certificate
    difference: dict[str, float]
    allowed: dict[str, float]

    @property
    def exact(self) -> bool:
        """Whether every output has the bits of the certificate."""
        return all(value == 0.0 for value in self.difference.values())

    @property
    def off(self) -> tuple[str, ...]:
        """Outputs that differ by more than is allowed, the furthest off first."""
        beyond = {n: value - self.allowed[n] for n, value in self.difference.items()}
        return tuple(sorted((n for n in beyond if beyond[n] > 0.0), key=lambda n: -beyond[n]))


def verify(path: str | Path, limits: Limits | None = None) -> Replay:
    """Replay the certificate of the FMU at `path`, in a worker process within `limits`; raises
    `FmuError` when it cannot be done, and `SimulationError` where the FMU ends its worker."""
    path = Path(path)
    with Fmu(path) as fmu:
        certificate = read_certificate(fmu)
    return compare(path, certificate, limits)


def compare(path: Path, certificate: Certificate, limits: Limits | None = None) -> Replay:
    """As `verify`, with a certificate that need not be in the FMU."""
    c = certificate
    rows = replay(path, c.step, c.rows, c.inputs, tuple(c.outputs), limits)
    difference, allowed = {}, {}
    for column, (name, values) in zip(rows.T, c.outputs.items(), strict=True):
        expected = np.array(values)
        equal = (column == expected) | (np.isnan(column) & np.isnan(expected))
        gap = np.where(equal, 0.0, np.abs(column - expected))
        difference[name] = float(np.max(np.where(np.isnan(gap), np.inf, gap), initial=0.0))
        allowed[name] = c.tolerance * float(np.ptp(np.nan_to_num(expected)))
    return Replay(c, difference, allowed)


def replay(
    path: Path,
    step: float,
    count: int,
    inputs: Mapping[str, tuple[float, ...]],
    outputs: tuple[str, ...],
    limits: Limits | None = None,
) -> Array:
    """Rows of `outputs` of the FMU at `path` after each of `count` steps with a row of `inputs` (if
    any) held, in a worker process within `limits`. The shape is (count, outputs).

    Raises `FmuError`, for a variable that the FMU does not have, too, and `SimulationError` where
    the worker dies.
    """

    def work(teller: Teller) -> Array:
        rows: list[list[float]] = []

        def logged(message: LogMessage) -> None:
            teller.marker.messages.put("parity", message)

        with (
            Fmu(path) as fmu,
            fmu.instantiate("parity", echo=logged) as instance,
        ):
            instance.enter_initialization_mode(0.0, None, None)
            instance.exit_initialization_mode()
            for k in range(count):
                teller.reached(k * step)
                instance.set({name: column[k] for name, column in inputs.items()})
                instance.do_step(k * step, step)
                rows.append([float(instance.get(name)) for name in outputs])
            instance.terminate()
        return np.array(rows, dtype=float).reshape(count, len(outputs))

    return run_task(work, limits=limits, file=path)
