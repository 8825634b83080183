"""What a run, study or sweep has left in a folder, read again.

    result = harness.open("runs/step")

Nothing is run and no FMU is opened. The experiment is the one that was run, as the folder holds it,
whatever has become of its file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from harness.errors import HarnessError, RecordingError
from harness.experiment.experiment import Experiment
from harness.experiment.journal import JOURNAL_FILE, RUN_FILE, Journal
from harness.experiment.study import Study, study_so_far
from harness.experiment.sweep import Region, run_sweep, sweep_so_far
from harness.results.manifest import COMPLETE, FILE_NAME, run_state
from harness.results.recording import read_recording
from harness.results.result import Result

_OTHERS = ("variants", "plots", "study", "sweep")

Reopened = Result | dict[str, Result] | Study | dict[str, Region]


def open_results(folder: str | Path) -> Reopened:
    """The `Result` of a single run, with its metrics; of a folder that `fmu-harness run` wrote the
    results by variant, the `Study`, or the regions of a sweep by variant, as far as they were done.
    Long columns are read when they are asked for. Raises `RecordingError`.
    """
    folder = Path(folder)
    if not (folder / RUN_FILE).exists():
        if not (folder / FILE_NAME).exists():
            raise RecordingError(
                f"{folder} holds no run, study or sweep: it has neither {RUN_FILE} nor {FILE_NAME}"
            )
        return _single(folder)
    try:
        held = json.loads((folder / RUN_FILE).read_text(encoding="utf-8"))
        experiment = Experiment.from_data(held["data"], Path(held["file"]))
        kind, variants = held.get("kind", "run"), tuple(map(str, held["variants"]))
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise RecordingError(f"{folder / RUN_FILE} cannot be read: {fault!r}") from fault
    if kind == "run":
        begun = [name for name in variants if (folder / name / FILE_NAME).exists()]
        return {name: experiment.recorded(name, folder / name) for name in begun}
    journal = Journal(folder / JOURNAL_FILE)
    journal.read()
    if kind == "study":
        return study_so_far(experiment, journal, variants)
    if run_state(folder) == COMPLETE:  # then all that it asks for is there
        return run_sweep(experiment, variants, journal=journal)
    return sweep_so_far(experiment, variants, journal)


def _single(folder: Path) -> Result:
    """A run of a script; the metrics are those that its experiment asked for."""
    result = read_recording(folder)
    data: dict[str, Any] = dict(result.manifest.experiment)
    file = Path(str(data.pop("file", folder)))
    data = {key: value for key, value in data.items() if key not in ("variant", *_OTHERS)}
    if "components" not in data:
        return result
    try:
        experiment = Experiment.from_data(data, file)
        return experiment.measured(result, experiment.spec)
    except HarnessError:  # of another version of the form; the rows are there
        return result
