"""What a run folder was made from: `experiment.json`, from which the run can be resumed.

It holds the content of the experiment file after settings, so that a resumed run is the run that
was begun, whatever has become of the file since.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from harness.errors import RecordingError
from harness.experiment.experiment import Experiment

RUN_FILE = "experiment.json"


@dataclass(frozen=True)
class RunRecord:
    """An experiment and the variants of it that are run into one folder."""

    experiment: Experiment
    variants: tuple[str, ...]

    def write(self, folder: Path) -> None:
        """Begin the folder; raises `RecordingError` where another run has, or it cannot be made."""
        content = {
            "file": str(self.experiment.path.resolve()),
            "variants": self.variants,
            "data": self.experiment.data,
        }
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with (folder / RUN_FILE).open("x", encoding="utf-8") as file:
                _write_or_remove(file, json.dumps(content, indent=2, default=str) + "\n")
        except FileExistsError as fault:
            raise RecordingError(
                f"the run folder {folder} holds a run already; nothing was changed in it: choose "
                f"another folder, or go on with it by `fmu-harness resume {folder}`"
            ) from fault
        except OSError as fault:
            raise RecordingError(
                f"cannot make the run folder {folder}: {fault.strerror or fault}; choose another "
                "one"
            ) from fault


def _write_or_remove(file: TextIO, text: str) -> None:
    try:
        file.write(text)
        file.flush()
    except OSError:
        Path(file.name).unlink(missing_ok=True)
        raise


def read_run(folder: Path) -> RunRecord:
    """What the run in `folder` was made from; raises `RecordingError`, `ExperimentError`."""
    path = folder / RUN_FILE
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        data, file, variants = held["data"], Path(held["file"]), tuple(map(str, held["variants"]))
    except FileNotFoundError as fault:
        raise RecordingError(
            f"{folder} holds no run of the command line: it has no {RUN_FILE}; give the folder "
            "that `fmu-harness run` named, or resume from Python with Bench.run(resume=True)"
        ) from fault
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise RecordingError(f"{path} cannot be read: {fault!r}") from fault
    return RunRecord(Experiment.from_data(data, file), variants)
