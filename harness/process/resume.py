"""Whether and from where a run folder can be continued.

The rows of a run that cannot be continued are brought into their final form. This module refuses
runs that are complete, and those whose components cannot save their state.
"""

from __future__ import annotations

from pathlib import Path

from harness.errors import RecordingError
from harness.process.checkpoint import Snapshot, read_checkpoint
from harness.results.manifest import COMPLETE, read_manifest
from harness.results.storage import CSV_FILE, seal


def resumable(folder: Path) -> Snapshot | None:
    """The last checkpoint of the run in `folder`, None where it has to begin anew.

    Raises `RecordingError` where there is no run, or it is complete, or cannot be continued.
    """
    manifest = read_manifest(folder)
    if manifest.status.state == COMPLETE:
        raise RecordingError(f"the run in {folder} is complete; there is nothing to resume")
    content = read_checkpoint(folder)
    if content is None:
        if manifest.not_resumable:
            seal(folder)
            raise RecordingError(
                f"the run in {folder} cannot be resumed: {manifest.not_resumable}; its rows so far "
                f"are in {CSV_FILE}, run it again into another folder"
            )
        return None
    try:
        return Snapshot.from_bytes(content)
    except RecordingError as fault:
        raise RecordingError(f"{folder}: {fault}; run it again into another folder") from fault
