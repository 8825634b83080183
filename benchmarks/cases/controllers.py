"""placeholder"""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.frame import Comparison, Setting


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """To come."""
    yield from ()
