"""What one check of an FMU's behaviour found."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from harness.errors import HarnessError


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


def passed(detail: str, **data: Any) -> Finding:
    """A finding of a check that passed."""
    return Finding("", Verdict.PASSED, detail, data=data)


def failed(detail: str, *lies: str, **data: Any) -> Finding:
    """A finding of a check that failed; `lies` are the statements that it contradicts."""
    return Finding("", Verdict.FAILED, detail, lies, data)


class VerdictError(Exception):
    """Ends a check early with its `finding`."""

    def __init__(self, finding: Finding) -> None:
        """Whoever runs the check catches it."""
        super().__init__(finding.detail)
        self.finding = finding


def require(offered: object, otherwise: str) -> None:
    """End the check unless the FMU offers what it needs; `otherwise` says what is lacking."""
    if not offered:
        raise VerdictError(Finding("", Verdict.NOT_OFFERED, otherwise))


@contextmanager
def claimed(statement: str) -> Iterator[None]:
    """A `HarnessError` in here contradicts a statement of the model description."""
    try:
        yield
    except HarnessError as fault:
        raise VerdictError(failed(str(fault), statement)) from fault
