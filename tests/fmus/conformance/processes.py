"""Python in a process of its own, from the root of the project, with its words on failure."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parents[3]


def python_path(*first: str | Path) -> str:
    """Folders to import from: `first`, the project, and those of this process's environment, where
    other packages with plants may be."""
    given = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return os.pathsep.join([*map(str, first), str(ROOT), *filter(None, given)])


def run_python(
    *arguments: str | Path, cwd: Path = ROOT, changed: Mapping[str, str | None] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run `python ARGUMENTS` with some environment variables changed (None: removed)."""
    environment: dict[str, str | None] = {**os.environ, "PYTHONPATH": python_path()}
    environment.update(changed or {})
    result = subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=cwd,
        env={name: value for name, value in environment.items() if value is not None},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result
