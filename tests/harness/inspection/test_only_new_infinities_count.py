"""A value that is not finite is a fault, unless it is internal and was so from the beginning."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.inspection.rows import not_finite

SUBJECT: Any = SimpleNamespace(
    labels=("y", "limits", "limits", "x"),
    watched=[
        SimpleNamespace(causality="output", size=1), SimpleNamespace(causality="local", size=2),
    ],
)  # fmt: skip
"""An output, a local array, and a continuous state."""


@pytest.mark.parametrize(
    ("first", "later", "bad"),
    [
        ([0, 1, 1, 1], [0, 1, 1, 1], [False] * 4),
        ([0, 1, np.inf, 1], [0, 1, np.inf, 1], [False] * 4),
        ([0, 1, 1, 1], [0, 1, np.inf, 1], [False, False, True, False]),
        ([np.inf, 1, 1, 1], [np.inf, 1, 1, 1], [True, False, False, False]),
        ([0, 1, 1, np.nan], [0, 1, 1, 1], [False, False, False, True]),
    ],
)
def test_what_counts(first: list[float], later: list[float], bad: list[bool]) -> None:
    found = not_finite(SUBJECT, np.array(first), np.array([later, later]))
    assert found.tolist() == bad
