"""Examines the behaviour of an FMU in disposable processes, and draws the conclusions."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from harness.fmi.archive.temporary import temporary_folder
from harness.fmi.binding.interface import (
    CO_SIMULATION,
    MODEL_EXCHANGE,
    SCHEDULED_EXECUTION,
    capabilities,
    offered,
)
from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.inspection.allowances import Allowance, allowances
from harness.inspection.examination_process import Examination, Progress
from harness.inspection.finding import Finding, Verdict
from harness.participants.kinds import load_kernels

DEADLINE = 60.0
"""Seconds that one check may take."""


@dataclass(frozen=True)
class Diagnosis:
    """All findings about an FMU; `allowances` are what they mean for its use."""

    path: Path
    sha256: str
    description: ModelDescription
    findings: tuple[Finding, ...]

    @property
    def lies(self) -> tuple[str, ...]:
        """Statements of the model description that the behaviour contradicts."""
        return tuple(dict.fromkeys(lie for f in self.findings for lie in f.lies))

    @property
    def healthy(self) -> bool:
        """Whether no check failed."""
        return all(f.verdict is not Verdict.FAILED for f in self.findings)

    @property
    def allowances(self) -> tuple[Allowance, ...]:
        """The uses that the FMU might be put to, and whether the findings allow them."""
        return allowances(self.description, self.findings)

    def as_data(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "fmu": str(self.path),
            "sha256": self.sha256,
            "fmi_version": self.description.fmi_version,
            "healthy": self.healthy,
            "findings": [asdict(f) for f in self.findings],
            "lies": list(self.lies),
            "allowed": {a.use: a.allowed for a in self.allowances},
            "reasons": {a.use: a.reason for a in self.allowances if not a.allowed},
        }


def examine(
    path: Path,
    *,
    deadline: float = DEADLINE,
    progress: Progress | None = None,
    validate: bool = True,
) -> Diagnosis:
    """Examine the FMU at `path`, each kind of interface that it offers.

    `deadline` (s) bounds each check; without `validate`, faults of the description that do not
    keep it from being read are let pass. Raises `FmuError` when the FMU cannot even be read, or
    offers neither co-simulation nor model exchange.
    """
    with Fmu(path, validate=validate) as fmu:
        sha256, description = fmu.sha256, fmu.description
    kinds = [kind for kind in offered(description) if kind != SCHEDULED_EXECUTION]
    if not kinds:
        capabilities(description, CO_SIMULATION)
    load_kernels(exchange=MODEL_EXCHANGE in kinds)  # the deadline is that of the FMU
    findings: list[Finding] = []
    with temporary_folder() as folder:
        examination = Examination(path, folder, deadline, progress)
        for kind in kinds:
            findings += examination.findings(kind)
        findings += examination.elsewhere(findings)
    by_kind = [finding for kind in kinds for finding in findings if finding.interface_type == kind]
    return Diagnosis(path, sha256, description, tuple(by_kind))
