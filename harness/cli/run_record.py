"""What a run folder was made from: `experiment.json`, from which the run can be resumed.

It holds the content of the experiment file after settings, so that a resumed run is the run that
was begun, whatever has become of the file since. A package (SSP) is unpacked while a run lasts
only, so it is opened again; a run whose package is gone or has changed does not go on.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.errors import RecordingError
from harness.experiment.experiment import Experiment
from harness.results.atomic import ANOTHER_FOLDER, writing
from harness.ssp import is_package

RUN_FILE = "experiment.json"
_PACKAGE_FILES = (".ssd", ".ssv", ".ssm", ".ssb", ".ssp", ".fmu", ".csv")


@dataclass(frozen=True)
class RunRecord:
    """An experiment and the variants of it that are run into one folder; `settings` are those with
    which it was opened."""

    experiment: Experiment
    variants: tuple[str, ...]
    settings: Mapping[str, Any] = field(default_factory=dict)

    def write(self, folder: Path) -> None:
        """Begin the folder; raises `RecordingError` where another run has, or it cannot be made."""
        path = self.experiment.path.resolve()
        content: dict[str, Any] = {
            "file": str(path),
            "variants": self.variants,
            "data": self.experiment.data,
        }
        if is_package(path):
            content["package"] = {"settings": self.settings, "sha256": _digest(path)}
        text = json.dumps(content, indent=2, default=str) + "\n"
        with writing(f"cannot make the run folder {folder}", folder, way_out=ANOTHER_FOLDER):
            file = folder / RUN_FILE
            try:
                with file.open("x", encoding="utf-8") as opened:
                    opened.write(text)
            except FileExistsError as fault:
                raise RecordingError(
                    f"the run folder {folder} holds a run already; nothing was changed in it: "
                    f"choose another folder, or go on with it by `fmu-harness resume {folder}`"
                ) from fault
            except OSError:
                file.unlink(missing_ok=True)
                raise


@contextmanager
def opened_run(folder: Path) -> Iterator[RunRecord]:
    """What the run in `folder` was made from, while its files are there; raises `RecordingError`,
    `ExperimentError`."""
    path = folder / RUN_FILE
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        data, file, variants = held["data"], Path(held["file"]), tuple(map(str, held["variants"]))
        package = held.get("package")
        settings, digest = (package["settings"], package["sha256"]) if package else ({}, "")
    except FileNotFoundError as fault:
        raise RecordingError(
            f"{folder} holds no run of the command line: it has no {RUN_FILE}; give the folder "
            "that `fmu-harness run` named, or resume from Python with Bench.run(resume=True)"
        ) from fault
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise RecordingError(f"{path} cannot be read: {fault!r}") from fault
    if not package:
        yield RunRecord(Experiment.from_data(data, file), variants)
        return
    if _digest(file) != digest:
        what = "has changed since" if file.exists() else "is gone"
        raise RecordingError(
            f"the run in {folder} cannot go on: the package {file} that it runs {what}; put the "
            "one back with which it was begun, or run anew into another folder"
        )
    from harness.ssp.to_experiment import open_experiment

    with open_experiment(file, settings) as experiment:
        yield RunRecord(experiment, variants, settings)


def _digest(package: Path) -> str:
    """Of the content of a package: of the file, or of the files in a folder that may belong to it;
    empty for what cannot be read."""
    files = [package]
    if package.is_dir():
        files = sorted(p for p in package.rglob("*") if p.suffix in _PACKAGE_FILES)
    digest = hashlib.sha256()
    try:
        for path in files:
            content = path.read_bytes()
            digest.update(f"{path.relative_to(package)}\0{len(content)}\0".encode())
            digest.update(content)
    except OSError:
        return ""
    return digest.hexdigest()
