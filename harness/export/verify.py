"""Replays the parity certificate of an FMU on this machine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.export.certificate import (
    Certificate,
    allowed,
    differences,
    read_certificate,
    replay,
)
from harness.fmi.fmu import Fmu


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


def verify(path: str | Path) -> Replay:
    """Replay the certificate of the FMU at `path`; raises `FmuError` when it cannot be done."""
    with Fmu(path) as fmu:
        certificate = read_certificate(fmu)
        rows = replay(
            fmu, certificate.step, certificate.rows, certificate.inputs, tuple(certificate.outputs)
        )
    return Replay(certificate, differences(rows, certificate), allowed(certificate))
