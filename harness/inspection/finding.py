"""What one check of an FMU's behaviour found."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any


class Verdict(StrEnum):
    """How a check ended."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_OFFERED = "not offered"
    """The FMU says that it cannot, and was not asked to."""


@dataclass(frozen=True)
class Finding:
    """The verdict of the check called `check` and a phrase of `detail`; whoever runs the check
    gives it its name and the kind of interface that was examined.

    `lies` are statements of the model description that the behaviour contradicts; `data` are
    figures for other programs.
    """

    check: str
    verdict: Verdict
    detail: str
    lies: tuple[str, ...] = ()
    data: dict[str, Any] = field(default_factory=dict)
    interface_type: str = ""

    def as_data(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self) | {"verdict": str(self.verdict), "lies": list(self.lies)}

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Finding:
        """The finding that `as_data` wrote."""
        changed = {"verdict": Verdict(data["verdict"]), "lies": tuple(data["lies"])}
        return cls(**{**data, **changed})


def passed(detail: str, **data: Any) -> Finding:
    """A finding of a check that passed."""
    return Finding("", Verdict.PASSED, detail, data=data)


def failed(detail: str, *lies: str, **data: Any) -> Finding:
    """A finding of a check that failed; `lies` are the statements that it contradicts."""
    return Finding("", Verdict.FAILED, detail, lies, data)


def not_offered(detail: str) -> Finding:
    """A finding of something that the FMU does not offer."""
    return Finding("", Verdict.NOT_OFFERED, detail)
