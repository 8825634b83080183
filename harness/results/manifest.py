"""What a run was made of: `manifest.json`, written when the run starts and again when it ends.

With the manifest and the files that it names by hash, a run can be repeated and judged: versions,
platform, seeds, FMU hashes, the resolved experiment, and how far it came.
"""

from __future__ import annotations

import dataclasses
import json
import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from harness.errors import RecordingError
from harness.results.atomic import atomic_write
from harness.results.columns import Column

FILE_NAME = "manifest.json"
DEPENDENCIES = ("fmpy", "numpy", "scipy", "casadi", "numba", "llvmlite", "pythonfmu", "pyarrow")

RUNNING, COMPLETE, INCOMPLETE = "running", "complete", "incomplete"


@dataclass(frozen=True)
class RunStatus:
    """How a run ended: `state` is "running", "complete" or "incomplete"; `until` the last
    recorded time (s, None where no row was recorded); `reason` why it ended early."""

    state: str
    until: float | None = None
    reason: str = ""

    def __str__(self) -> str:
        """One phrase, e.g. "incomplete until t = 1.5 s: ..."."""
        until = "" if self.until is None else f" until t = {self.until:g} s"
        return f"{self.state}{until}" + (f": {self.reason}" if self.reason else "")


@dataclass(frozen=True)
class FmuRecord:
    """An FMU that took part: instance name, file name and SHA-256 of the archive (hexadecimal)."""

    instance: str
    file: str
    sha256: str


@dataclass(frozen=True)
class Manifest:
    """The content of `manifest.json`. `seeds` by name of the random source, `experiment` resolved
    to plain data; `wall_time` in seconds; `not_resumable`: why the run has no checkpoints;
    `notes` say what was chosen where the experiment says nothing, and what had to be left out or
    done otherwise."""

    columns: tuple[Column, ...] = ()
    status: RunStatus = field(default_factory=lambda: RunStatus(RUNNING))
    fmus: tuple[FmuRecord, ...] = ()
    seeds: Mapping[str, Any] = field(default_factory=dict)
    experiment: Mapping[str, Any] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=lambda: software_versions())
    platform: str = field(default_factory=platform.platform)
    started: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))
    wall_time: float | None = None
    not_resumable: str = ""
    notes: tuple[str, ...] = ()
    format: int = 1

    def write(self, folder: Path) -> None:
        """Writes `manifest.json`, whole or not at all."""
        text = json.dumps(dataclasses.asdict(self), indent=2, default=_plain, ensure_ascii=False)
        with atomic_write(folder / FILE_NAME) as partial:
            partial.write_text(text + "\n", encoding="utf-8")


def read_manifest(folder: Path) -> Manifest:
    """The manifest in `folder`; raises `RecordingError` where there is none or it is damaged."""
    path = folder / FILE_NAME
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        data["columns"] = tuple(Column(**one) for one in data["columns"])
        data["status"] = RunStatus(**data["status"])
        data["fmus"] = tuple(FmuRecord(**one) for one in data["fmus"])
        data["notes"] = tuple(data.get("notes", ()))
        return Manifest(**data)
    except FileNotFoundError as fault:
        raise RecordingError(f"{folder} is no run folder: it holds no {FILE_NAME}") from fault
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise RecordingError(f"{path} cannot be read as a manifest: {fault!r}") from fault


def run_state(folder: Path) -> str:
    """The state of the run in `folder`, "" where none was begun; raises `RecordingError`."""
    return read_manifest(folder).status.state if (folder / FILE_NAME).exists() else ""


def software_versions() -> dict[str, str]:
    """Versions of Python, the harness and what it computes with; "not installed" where absent."""
    packages = {name: _installed(name) for name in ("fmu-harness", *DEPENDENCIES)}
    return {"python": platform.python_version(), **packages}


@cache
def _installed(package: str) -> str:
    """Read once a process: a run takes less time than to read them."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _plain(value: Any) -> Any:
    """Numpy scalars and arrays, paths and dataclasses as JSON knows them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    return repr(value)
