"""The runs of a study or sweep as they are done, a line each in `runs.jsonl`.

Whoever does a run notes it, in whatever process, so nothing that is done is lost when the study
ends early, and a study that goes on leaves out what is noted.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from harness.results.atomic import writing

JOURNAL_FILE = "runs.jsonl"
RUN_FILE = "experiment.json"
"""What a folder of the command line was made from."""

Metrics = Mapping[str, float | None]
Settings = tuple[tuple[str, float], ...]
"""Keys of an experiment with their values."""


@dataclass(frozen=True)
class Point:
    """One run: its name in messages, its seed, and what it changes in the experiment."""

    name: str
    seed: int
    settings: Settings = ()


@dataclass
class Journal:
    """What is done of a study or sweep: `found` has the metrics of each run by variant and point,
    None where it ended early; `path` is the file, or None for one in memory."""

    path: Path | None = None
    found: dict[tuple[str, Point], Metrics | None] = field(default_factory=dict)

    def read(self) -> None:
        """Take over what the file has; a line that was cut off is a run that was not done."""
        if self.path is None or not self.path.exists():
            return
        with writing(f"{self.path} cannot be read"):
            lines = self.path.read_text(encoding="utf-8").splitlines()
        for line in lines:
            try:
                held = json.loads(line)
                settings = tuple((key, float(value)) for key, value in held["settings"])
                point = Point(held["point"], held["seed"], settings)
                self.found[held["variant"], point] = held["metrics"]
            except (ValueError, KeyError, TypeError):
                continue


def note(path: Path | None, variant: str, point: Point, metrics: Metrics | None) -> None:
    """Add a run to the file, in one piece."""
    if path is None:
        return
    held = {
        "variant": variant, "point": point.name, "seed": point.seed, "settings": point.settings,
        "metrics": None if metrics is None else dict(metrics),
    }  # fmt: skip
    with writing(f"{path} cannot be written", path.parent):
        descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
        try:
            os.write(descriptor, f"{json.dumps(held)}\n".encode())
        finally:
            os.close(descriptor)
