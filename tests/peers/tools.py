"""The tools that our FMUs are tried in, by the name of their driver."""

from __future__ import annotations

import importlib.util

import pytest

MASTERS = {"fmpy": "fmpy", "ecos": "ecospy", "libcosim": "libcosimpy"}
TOOLS = {**MASTERS, "casadi": "casadi"}

SOLVERS = {"fmpy", "casadi", "fmusim", "fmucheck"}
"""Those that solve equations (model exchange)."""


def installed(tool: str) -> bool:
    """Whether the tool's package is there."""
    return importlib.util.find_spec(TOOLS[tool]) is not None


def skip_without(tool: str) -> None:
    """End the test where the tool is not installed."""
    if not installed(tool):
        pytest.skip(f"{TOOLS[tool]} is not installed (extra 'peers')")
