"""Replays the parity certificate of an FMU on this machine, in a process of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.export.certificate import (
    Certificate,
    allowed,
    differences,
    read_certificate,
    replay_apart,
)
from harness.fmi.fmu import Fmu
from harness.process.limits import Limits


@dataclass(frozen=True)
class Replay:
    """The largest difference of each output here (`difference`), and what is `allowed`."""

    certificate: Certificate
    difference: dict[str, float]
    allowed: dict[str, float]

    @property
    def exact(self) -> bool:
        """Whether every output has the bits of the certificate."""
        return all(value == 0.0 for value in self.difference.values())

    @property
    def off(self) -> tuple[str, ...]:
        """Outputs that differ by more than is allowed."""
        return tuple(n for n, value in self.difference.items() if value > self.allowed[n])


def verify(path: str | Path, limits: Limits | None = None) -> Replay:
    """Replay the certificate of the FMU at `path`, in a worker process within `limits`; raises
    `FmuError` when it cannot be done, and `SimulationError` where the FMU ends its worker."""
    path = Path(path)
    with Fmu(path) as fmu:
        certificate = read_certificate(fmu)
    rows = replay_apart(
        path,
        certificate.step,
        certificate.rows,
        certificate.inputs,
        tuple(certificate.outputs),
        limits,
    )
    return Replay(certificate, differences(rows, certificate), allowed(certificate))
